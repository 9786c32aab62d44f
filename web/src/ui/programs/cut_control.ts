// SPDX-License-Identifier: Apache-2.0
// Force, removal and feed along the selected program: asked for when it has moved, and plotted by a chunk
// that is loaded when there is something to plot.

import type { ForceCurve } from '../../model/force_curve';
import { cutCurveOf } from '../../model/cut_curve';
import type { FeedCurve } from '../../model/program_path';
import { isOpen } from '../../model/programs';
import type { ProgramInfo } from '../../wire/types';
import { h } from '../dom';
import type { CutPlot } from './cut_plot';

const AGAIN_MS = 2000;
/** The server carves the journal again for the forces: at most this share of the time. */
const SHARE = 0.05;

export class CutControl {
  readonly element = h('div', { class: 'program-cut', hidden: '' });
  private plot_: Promise<CutPlot> | null = null;
  private shown_: CutPlot | null = null;
  private program_: number | null = null;
  /** Motions of the program that are in the curve, or were asked for. */
  private motions_ = 0;
  private busy_ = false;
  private nextMs_ = -Infinity;

  /**
   * @param ask for the curve of what a participant has carved
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
    this.element.hidden = true;
    this.plot_ = null;
    this.shown_ = null;
  }

  /** Takes how far the program has come; call often while the panel is open. */
  update(program: ProgramInfo, nowMs: number): void {
    if (program.id !== this.program_) return;
    this.shown_?.setNow(isOpen(program) && program.motions_done > 0 ? program.elapsed_s : null);
    this.shown_?.setFeeds(this.feeds()); // the path may come later than the forces
    const isNewer = program.motions_done !== this.motions_;
    if (isNewer && !this.busy_ && nowMs >= this.nextMs_) void this.refresh_(program);
  }

  private async refresh_(program: ProgramInfo): Promise<void> {
    this.busy_ = true;
    this.motions_ = program.motions_done;
    const beganMs = performance.now();
    try {
      const curve = await this.ask(program.participant);
      if (curve && curve.first.length > 0) await this.show_(program, curve);
    } catch (problem) {
      console.warn('No forces along the program:', problem);
    }
    const endMs = performance.now();
    this.nextMs_ = endMs + Math.max(AGAIN_MS, (endMs - beganMs) / SHARE);
    this.busy_ = false;
  }

  private async show_(program: ProgramInfo, curve: ForceCurve): Promise<void> {
    if (program.id !== this.program_) return;
    this.plot_ ??= this.load().then(({ CutPlot }) => new CutPlot(this.picked));
    const plot = await this.plot_;
    if (program.id !== this.program_) return;
    if (this.shown_ !== plot) this.element.replaceChildren(plot.element);
    this.shown_ = plot;
    this.element.hidden = false;
    plot.show(cutCurveOf(curve), program.programmed_s);
    plot.setFeeds(this.feeds());
  }
}
