// SPDX-License-Identifier: Apache-2.0
// The button that opens the panel of NC programs. The panel is a chunk of its own.

import { t } from '../../strings';
import type { SessionModel } from '../../model/session';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import { lazyPanel } from '../lazy_panel';
import type { OneOpen } from '../one_open';
import type { PathHost } from './path_control';

/**
 * Adds the button to a toolbar; the panel goes beside it when it is opened first.
 * @param host the picture, into which it draws the path
 * @param oneOpen closes it when another part opens
 * @param layoutChanged it was opened or closed
 */
export function mountPrograms(
  model: SessionModel,
  session: string,
  toolbar: HTMLElement,
  host: PathHost,
  oneOpen: OneOpen,
  layoutChanged: () => void,
): void {
  const toggle = lazyPanel('programs panel', async () => {
    const { ProgramsPanel } = await import('./programs_panel');
    return new ProgramsPanel(model, session, button, host, oneOpen, layoutChanged);
  });
  const button = iconButton(ICONS.program, t('NC programs'), '', toggle);
  button.setAttribute('aria-expanded', 'false');
  toolbar.prepend(button);
}
