// SPDX-License-Identifier: Apache-2.0

import type { Signal } from '@preact/signals';
import { t } from '../../strings';
import type { SpaceMouse } from './space_mouse';

/** Opens the 3D mouse that the user has allowed before or, with `asks`, chooses now. */
export async function openSpaceMouse(
  mouse: SpaceMouse,
  asks: boolean,
  isThere: Signal<boolean>,
  say: (text: string) => void,
): Promise<void> {
  try {
    await mouse.open(asks);
    isThere.value = mouse.isThere;
  } catch (problem) {
    say(t('The 3D mouse could not be opened: {0}', (problem as Error).message));
  }
}
