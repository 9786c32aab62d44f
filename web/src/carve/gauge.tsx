// SPDX-License-Identifier: Apache-2.0
// The force on one's own tool, next to the pointer: a ring that fills, and the figure in it.

import { signal } from '@preact/signals';
import { figure } from '../ui/format';

const STALE_MS = 250; // without an answer for so long, nothing is felt
const ASIDE_PX = 34;

export class Gauge {
  /** The place of the picture next to which the gauge is shown; null: nowhere. */
  readonly place = signal<{ x: number; y: number } | null>(null);
  private readonly shownN_ = signal(0);
  private readonly share_ = signal(0);
  private sinceN_: number | null = null; // the greatest one since the last update
  private feltMs_ = -Infinity;

  /** The force on the tool now, N, as a signal's value. */
  get forceN(): number {
    return this.shownN_.value;
  }

  /** The same as a share of the force that fills the ring, at most 1. */
  get share(): number {
    return this.share_.value;
  }

  feel(forceN: number, nowMs: number): void {
    this.sinceN_ = Math.max(this.sinceN_ ?? 0, forceN);
    this.feltMs_ = nowMs;
  }

  /** `fullN`: the force that fills the ring. */
  update(fullN: number, nowMs: number): void {
    // Between the moves of a pointer the tool rests, without force.
    if (this.sinceN_ !== null) this.shownN_.value = this.sinceN_;
    else if (nowMs - this.feltMs_ > STALE_MS) this.shownN_.value = 0;
    this.sinceN_ = null;
    this.share_.value = Math.min(1, this.shownN_.peek() / Math.max(fullN, 0.1));
  }
}

export function GaugeView({ gauge }: { gauge: Gauge }) {
  const { value: place } = gauge.place;
  const [x, y] = place ? [place.x + ASIDE_PX, place.y - ASIDE_PX] : [0, 0];
  return (
    <div
      class={gauge.forceN < 0.005 ? 'carve-gauge rests' : 'carve-gauge'}
      hidden={place === null}
      style={
        `--share:${gauge.share.toFixed(3)};` +
        `transform:translate(-50%, -50%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`
      }
    >
      <span>{`${figure(gauge.forceN)} N`}</span>
    </div>
  );
}
