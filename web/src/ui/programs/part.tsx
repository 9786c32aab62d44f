// SPDX-License-Identifier: Apache-2.0
// The action that opens the panel of NC programs. The panel is a chunk of its own, and made when it is
// opened first.

import type { VNode } from 'preact';
import { t } from '../../strings';
import type { ProgramPlace } from '../../model/program_place';
import type { ButtonAction } from '../actions';
import { ICONS } from '../icons';
import { LazyPanel } from '../lazy_panel';
import { Live } from '../live';
import type { ProgramsHost } from './host';
import type { ProgramsPanel } from './programs_panel';

export class ProgramsPart {
  readonly action: ButtonAction;
  private readonly panel_: LazyPanel<ProgramsPanel>;
  private wanted_: ProgramPlace | null = null;

  constructor(private readonly host: ProgramsHost) {
    this.panel_ = new LazyPanel('programs panel', async () => {
      const { ProgramsPanel } = await import('./programs_panel');
      const panel = new ProgramsPanel(host);
      if (this.wanted_) panel.showLine(this.wanted_);
      return panel;
    });
    this.action = {
      ...{ name: 'programs', label: t('NC programs'), key: '', icon: ICONS.program },
      isExpanded: () => host.shell.isProgramsOpen.value,
      perform: () => this.panel_.toggle(),
    };
  }

  view(): VNode {
    return <Live view={() => this.panel_.loaded?.view()} />;
  }

  /** Opens the panel at a line of a program. */
  showLine(place: ProgramPlace): void {
    this.wanted_ = place;
    this.panel_.loaded?.showLine(place);
    if (!this.host.shell.isProgramsOpen.peek()) this.panel_.toggle();
  }
}
