// SPDX-License-Identifier: Apache-2.0
// The button that opens the panel of NC programs. The panel is a chunk of its own.

import type { SessionModel } from '../../model/session';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import type { PathHost } from './path_control';

/**
 * Adds the button to a toolbar; the panel goes beside it when it is opened first.
 * @param host the picture, into which it draws the path
 * @param layoutChanged it was opened or closed
 */
export function mountPrograms(
  model: SessionModel,
  session: string,
  toolbar: HTMLElement,
  host: PathHost,
  layoutChanged: () => void,
): void {
  let panel: { toggle: () => void } | null = null;
  let loading = false;
  const button = iconButton(ICONS.program, 'NC programs', '', () => {
    if (panel) {
      panel.toggle();
    } else if (!loading) {
      loading = true;
      import('./programs_panel').then(
        ({ ProgramsPanel }) => {
          panel = new ProgramsPanel(model, session, button, host, layoutChanged);
          panel.toggle();
        },
        (problem: unknown) => {
          loading = false; // the next press tries again
          console.warn('The programs panel did not load:', problem);
        },
      );
    }
  });
  button.setAttribute('aria-expanded', 'false');
  toolbar.prepend(button);
}
