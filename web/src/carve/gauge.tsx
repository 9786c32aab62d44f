// SPDX-License-Identifier: Apache-2.0
// The force on one's own tool, next to the pointer: a ring that fills, and the figure in it.

import { signal } from '@preact/signals';
import { figure } from '../ui/format';

const STALE_MS = 250; // without an answer for so long, nothing is felt
const HOLD_MS = 150; // between the moves of a mouse the tool rests, without force
const SMOOTH_MS = 100; // time constant of the low-pass that is shown
const SHOW_MS = 30; // between two pictures of it
const FIGURE_MS = 150; // between two figures, so that one can read them
const LEAST_N = 0.005;
const ASIDE_PX = 34;

/** A force, and its share of the one that fills the ring, at most 1. */
interface Shown {
  forceN: number;
  share: number;
}

/**
 * Shows the greatest force of the last HOLD_MS through a low-pass of first order, so that a mouse,
 * whose tool rests between its moves, does not make it fall to zero.
 */
export class Gauge {
  /** The place of the picture next to which the gauge is shown; null: nowhere. */
  readonly place = signal<{ x: number; y: number } | null>(null);
  readonly shown = signal<Shown>({ forceN: 0, share: 0 });
  /** As shown, N, and seldom changed. */
  readonly figureN = signal(0);
  private forceN_ = 0;
  private share_ = 0;
  private sinceN_: number | null = null; // the greatest one since the last update
  private felt_: { forceN: number; atMs: number }[] = []; // falling
  private feltMs_ = -Infinity;
  private updatedMs_ = -Infinity;
  private figureMs_ = -Infinity;

  /** The force on the tool now, N. */
  get forceN(): number {
    return this.forceN_;
  }

  /** The same as a share of the force that fills the ring, at most 1. */
  get share(): number {
    return this.share_;
  }

  feel(forceN: number, nowMs: number): void {
    this.sinceN_ = Math.max(this.sinceN_ ?? 0, forceN);
    this.feltMs_ = nowMs;
    this.felt_ = this.felt_.filter((one) => one.forceN > forceN);
    this.felt_.push({ forceN, atMs: nowMs });
  }

  /** `fullN`: the force that fills the ring. */
  update(fullN: number, nowMs: number): void {
    if (this.sinceN_ !== null) this.forceN_ = this.sinceN_;
    else if (nowMs - this.feltMs_ > STALE_MS) this.forceN_ = 0;
    this.sinceN_ = null;
    this.share_ = shareOf(this.forceN_, fullN);
    this.smooth_(fullN, nowMs);
  }

  private smooth_(fullN: number, nowMs: number): void {
    if (nowMs - this.updatedMs_ < SHOW_MS) return;
    this.felt_ = this.felt_.filter(({ atMs }) => nowMs - atMs <= HOLD_MS);
    const heldN = this.felt_[0]?.forceN ?? 0;
    const part = 1 - Math.exp(-(nowMs - this.updatedMs_) / SMOOTH_MS);
    this.updatedMs_ = nowMs;
    const { forceN: before } = this.shown.peek();
    const next = before + part * (heldN - before);
    const forceN = heldN === 0 && next < LEAST_N ? 0 : next;
    if (forceN !== before) this.shown.value = { forceN, share: shareOf(forceN, fullN) };
    if (nowMs - this.figureMs_ < FIGURE_MS) return;
    this.figureMs_ = nowMs;
    this.figureN.value = forceN;
  }
}

function shareOf(forceN: number, fullN: number): number {
  return Math.min(1, forceN / Math.max(fullN, 0.1));
}

export function GaugeView({ gauge }: { gauge: Gauge }) {
  const { value: place } = gauge.place;
  const { forceN, share } = gauge.shown.value;
  const [x, y] = place ? [place.x + ASIDE_PX, place.y - ASIDE_PX] : [0, 0];
  return (
    <div
      class={forceN < LEAST_N ? 'carve-gauge rests' : 'carve-gauge'}
      hidden={place === null}
      style={
        `--share:${share.toFixed(3)};` +
        `transform:translate(-50%, -50%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`
      }
    >
      <span>{`${figure(gauge.figureN.value)} N`}</span>
    </div>
  );
}
