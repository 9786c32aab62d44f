// SPDX-License-Identifier: Apache-2.0
// The button that opens the panel of NC programs. The panel is a chunk of its own.

import { t } from '../../strings';
import type { SessionModel } from '../../model/session';
import type { ProgramInfo } from '../../wire/types';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import { lazyPanel } from '../lazy_panel';
import type { OneOpen } from '../one_open';
import type { ProgramPlace } from '../../model/program_place';
import type { PathHost } from './path_control';
import type { ProgramsPanel } from './programs_panel';

/**
 * Adds the button to a toolbar. The panel is made when it is opened first.
 * @param host the picture, into which it draws the path
 * @param oneOpen closes it when another part opens
 * @param layoutChanged it was opened or closed
 * @param replay shows the cuts of a program again
 * @returns a function that opens it at a line of a program
 */
export function mountPrograms(
  model: SessionModel,
  session: string,
  toolbar: HTMLElement,
  host: PathHost,
  oneOpen: OneOpen,
  layoutChanged: () => void,
  replay: (program: ProgramInfo) => void,
): (place: ProgramPlace) => void {
  let wanted: ProgramPlace | null = null;
  let panel: ProgramsPanel | null = null;
  const toggle = lazyPanel('programs panel', async () => {
    const { ProgramsPanel } = await import('./programs_panel');
    panel = new ProgramsPanel(model, session, button, host, oneOpen, layoutChanged, replay);
    if (wanted) panel.showLine(wanted);
    return panel;
  });
  const button = iconButton(ICONS.program, t('NC programs'), '', toggle);
  button.setAttribute('aria-expanded', 'false');
  toolbar.prepend(button);
  return (place) => {
    wanted = place;
    panel?.showLine(place);
    if (button.getAttribute('aria-expanded') !== 'true') toggle();
  };
}
