// SPDX-License-Identifier: Apache-2.0
// Force, removal and feed along the selected program. They are requested when it has moved, and
// plotted by a chunk that is loaded when there is something to plot.

import type { ForceCurve } from '../../model/force_curve';
import { cutCurveOf } from '../../model/cut_curve';
import type { FeedCurve } from '../../model/program_path';
import { isOpen } from '../../model/programs';
import type { ProgramInfo } from '../../wire/types';
import { h } from '../dom';
import type { CutPlot } from './cut_plot';

const AGAIN_MS = 2000;
/** Greatest share of the time that the server carves the journal again for the forces. */
const SHARE = 0.05;

export class CutControl {
  /** The forces of the selected program have come, or of its latest motions. */
  arrived: (curve: ForceCurve) => void = () => undefined;
  readonly element = h('div', { class: 'program-cut', hidden: '' });
  private plot_: Promise<CutPlot> | null = null;
  private shown_: CutPlot | null = null;
  private program_: number | null = null;
  /** Motions of the program that are in the curve, or were requested. */
  private motions_ = 0;
  private isBusy_ = false; // or waits until it may request
  private nextMs_ = -Infinity;
  private latest_: ProgramInfo | null = null;

  /**
   * @param ask requests the curve of a participant's cuts
   * @param picked a time of the program; returns its line, if it is known
   * @param feeds along the program, once its path is known
   */
  constructor(
    private readonly ask: (participant: number) => Promise<ForceCurve | null>,
    private readonly picked: (timeS: number) => number | null,
    private readonly feeds: () => FeedCurve | null,
    private readonly load = () => import('./cut_plot'),
  ) {}

  /** Shows another program; null: none. */
  select(program: number | null): void {
    if (program === this.program_) return;
    this.program_ = program;
    this.motions_ = 0;
    this.nextMs_ = -Infinity;
    this.latest_ = null;
    this.element.hidden = true;
    this.plot_ = null;
    this.shown_ = null;
  }

  /** Shows how far the program has come. Reads the feeds, so that a calling effect tracks them. */
  update(program: ProgramInfo): void {
    if (program.id !== this.program_) return;
    this.latest_ = program;
    this.showNow_();
    const feeds = this.feeds(); // the path may come later than the forces
    this.shown_?.setFeeds(feeds);
    this.refreshIfNewer_();
  }

  private refreshIfNewer_(): void {
    const { latest_: latest } = this;
    if (!latest || latest.motions_done === this.motions_ || this.isBusy_) return;
    this.isBusy_ = true;
    const delayMs = Math.max(0, this.nextMs_ - performance.now());
    if (delayMs === 0) void this.refresh_();
    else setTimeout(() => void this.refresh_(), delayMs);
  }

  private async refresh_(): Promise<void> {
    const { latest_: program } = this;
    const beganMs = performance.now();
    try {
      if (program) await this.load_(program);
    } catch (problem) {
      console.warn('No forces along the program:', problem);
    }
    const endMs = performance.now();
    this.nextMs_ = endMs + Math.max(AGAIN_MS, (endMs - beganMs) / SHARE);
    this.isBusy_ = false;
    this.refreshIfNewer_();
  }

  private async load_(program: ProgramInfo): Promise<void> {
    this.motions_ = program.motions_done;
    const curve = await this.ask(program.participant);
    if (curve && curve.first.length > 0) await this.show_(program, curve);
  }

  private async show_(program: ProgramInfo, curve: ForceCurve): Promise<void> {
    if (program.id !== this.program_) return;
    this.arrived(curve);
    this.plot_ ??= this.load().then(({ CutPlot }) => new CutPlot(this.picked));
    const plot = await this.plot_;
    if (program.id !== this.program_) return;
    if (this.shown_ !== plot) this.element.replaceChildren(plot.element);
    this.shown_ = plot;
    this.element.hidden = false;
    plot.show(cutCurveOf(curve), program.programmed_s);
    plot.setFeeds(this.feeds());
    this.showNow_();
  }

  private showNow_(): void {
    const { latest_: latest } = this;
    if (!latest) return;
    const isUnderWay = isOpen(latest) && latest.motions_done > 0;
    this.shown_?.setNow(isUnderWay ? latest.elapsed_s : null);
  }
}
