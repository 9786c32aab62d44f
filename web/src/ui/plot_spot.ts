// SPDX-License-Identifier: Apache-2.0
// The place of the live plots, a chunk that is loaded when there is something to plot.

import { t } from '../strings';
import type { ForceHistory } from '../model/forces';
import { h } from './dom';
import type { Felt, Plots } from './plots';

const RETRY_S = 5;

export class PlotSpot {
  readonly element = h(
    'div',
    { class: 'plot-spot' },
    h('p', { class: 'quiet' }, t('No forces yet.')),
  );
  private plots_: Plots | null = null;
  private triedS_ = -Infinity;

  /** @param load loads the code that plots */
  constructor(
    private readonly colors: { force: string; torque: string },
    private readonly load = () => import('./plots'),
  ) {}

  /** As `Plots.show`. Loads the plots first, and again after a while if they do not load. */
  show(history: ForceHistory, nowS: number, felt: Felt): void {
    if (this.plots_) this.plots_.show(history, nowS, felt);
    else if (nowS - this.triedS_ >= RETRY_S) void this.open_(nowS);
  }

  private async open_(nowS: number): Promise<void> {
    this.triedS_ = nowS;
    try {
      const { Plots } = await this.load();
      if (this.plots_) return; // a try that took longer than the next one
      this.plots_ = new Plots(this.colors.force, this.colors.torque);
      this.element.replaceChildren(this.plots_.element);
    } catch (problem) {
      console.warn('The plots did not load:', problem);
    }
  }
}
