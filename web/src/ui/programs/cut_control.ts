// SPDX-License-Identifier: Apache-2.0
// Force, removal and feed along the selected program. They are requested when it has moved, and
// plotted by a chunk that is loaded when there is something to plot.

import { batch, computed, signal } from '@preact/signals';
import type { ComponentType } from 'preact';
import type { ForceCurve } from '../../model/force_curve';
import { cutCurveOf } from '../../model/cut_curve';
import type { CutCurve } from '../../model/cut_curve';
import type { FeedCurve } from '../../model/program_path';
import { isOpen } from '../../model/programs';
import type { WrenchPeak } from '../../model/wrench_path';
import type { ProgramInfo } from '../../wire/types';

const AGAIN_MS = 2000;
/** Greatest share of the time that the server carves the journal again for the forces. */
const SHARE = 0.05;

/** The view of a curve. */
export type CutPlotView = ComponentType<{ control: CutControl; curve: CutCurve }>;

export class CutControl {
  /** The curve of the selected program; null: none yet. */
  readonly curve = signal<CutCurve | null>(null);
  /** Where its force was greatest; empty: nowhere, or not known yet. */
  readonly peaks = signal<readonly WrenchPeak[]>([]);
  /** The view of the plots; null until it is loaded. */
  readonly plot = signal<CutPlotView | null>(null);
  private readonly latest_ = signal<ProgramInfo | null>(null);
  /** Where the program is, s; null: it does not move. */
  readonly nowS = computed(() => {
    const { value: latest } = this.latest_;
    return latest && isOpen(latest) && latest.motions_done > 0 ? latest.elapsed_s : null;
  });
  /** The time of the whole program, s. */
  readonly totalS = computed(() =>
    Math.max(this.latest_.value?.programmed_s ?? 0, this.curve.value?.timesS.at(-1) ?? 0, 1e-3),
  );
  private program_: number | null = null;
  /** Motions of the program that are in the curve, or were requested. */
  private motions_ = 0;
  private isBusy_ = false; // or waits until it may request
  private nextMs_ = -Infinity;

  /**
   * @param ask requests the curve of a participant's cuts
   * @param picked a time of the program; returns its line, if it is known
   * @param feeds along the program, as a signal's value; null until its path is known
   * @param load loads the view
   */
  constructor(
    private readonly ask: (participant: number) => Promise<ForceCurve | null>,
    readonly picked: (timeS: number) => number | null,
    readonly feeds: () => FeedCurve | null,
    private readonly load: () => Promise<{ CutPlot: CutPlotView }>,
  ) {}

  /** Shows another program; null: none. */
  select(program: number | null): void {
    if (program === this.program_) return;
    this.program_ = program;
    this.motions_ = 0;
    this.nextMs_ = -Infinity;
    batch(() => {
      this.latest_.value = this.curve.value = null;
      this.peaks.value = [];
    });
  }

  /** Shows how far the program has come. */
  update(program: ProgramInfo): void {
    if (program.id !== this.program_) return;
    this.latest_.value = program;
    this.refreshIfNewer_();
  }

  private refreshIfNewer_(): void {
    const latest = this.latest_.peek();
    if (!latest || latest.motions_done === this.motions_ || this.isBusy_) return;
    this.isBusy_ = true;
    const delayMs = Math.max(0, this.nextMs_ - performance.now());
    if (delayMs === 0) void this.refresh_();
    else setTimeout(() => void this.refresh_(), delayMs);
  }

  private async refresh_(): Promise<void> {
    const program = this.latest_.peek();
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
    if (!curve || curve.first.length === 0) return;
    const { CutPlot } = await this.load();
    if (program.id !== this.program_) return;
    batch(() => {
      this.plot.value = CutPlot;
      this.curve.value = cutCurveOf(curve);
      this.peaks.value = curve.peaks;
    });
  }
}
