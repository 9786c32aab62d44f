// SPDX-License-Identifier: Apache-2.0
// The button that opens the panel of NC programs. The panel is a chunk of its own.

import { t } from '../../strings';
import type { ProgramPlace } from '../../model/program_place';
import { iconButton } from '../dom';
import { ICONS } from '../icons';
import { lazyPanel } from '../lazy_panel';
import type { ProgramsHost } from './host';
import type { ProgramsPanel } from './programs_panel';

/**
 * Adds the button to the toolbar. The panel is made when it is opened first.
 * @returns a function that opens it at a line of a program
 */
export function mountPrograms(host: ProgramsHost): (place: ProgramPlace) => void {
  let wanted: ProgramPlace | null = null;
  let panel: ProgramsPanel | null = null;
  const toggle = lazyPanel('programs panel', async () => {
    const { ProgramsPanel } = await import('./programs_panel');
    panel = new ProgramsPanel(host, button);
    if (wanted) panel.showLine(wanted);
    return panel;
  });
  const button = iconButton(ICONS.program, t('NC programs'), '', toggle);
  button.setAttribute('aria-expanded', 'false');
  host.toolbar.prepend(button);
  return (place) => {
    wanted = place;
    panel?.showLine(place);
    if (button.getAttribute('aria-expanded') !== 'true') toggle();
  };
}
