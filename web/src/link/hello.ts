// SPDX-License-Identifier: Apache-2.0
// The first message of a viewer.

import type { Look } from '../wire/types';
import { viewBudget } from './budget';

/**
 * The message with which a viewer joins. `look`: null if one follows the welcome; `budget`: bytes of
 * the surface per second, 0: any; `color`: empty: the server's choice.
 */
export function helloText(
  name: string,
  look: Look | null,
  budget = viewBudget(),
  color = '',
): string {
  return JSON.stringify({
    type: 'hello',
    name,
    changes: true,
    repeat: true,
    verify: true,
    look: look ?? true,
    ...(budget > 0 ? { budget } : {}),
    ...(color === '' ? {} : { color }),
  });
}
