// SPDX-License-Identifier: Apache-2.0
// The force on one's own tool, next to the pointer: a ring that fills, and the figure in it.

import { h, setText } from '../ui/dom';
import { figure } from '../ui/format';

const STALE_MS = 250; // without an answer for so long, nothing is felt
const ASIDE_PX = 34;

export class Gauge {
  readonly element = h('div', { class: 'carve-gauge', hidden: '' });
  private readonly text_ = h('span');
  private shownN_ = 0;
  private share_ = 0;
  private sinceN_: number | null = null; // the greatest one since the last update
  private feltMs_ = -Infinity;

  constructor() {
    this.element.append(this.text_);
  }

  /** The force on the tool now, N. */
  get forceN(): number {
    return this.shownN_;
  }

  /** Beside a place of the picture; null: nowhere. */
  place(place: { x: number; y: number } | null): void {
    this.element.hidden = place === null;
    if (!place) return;
    const [x, y] = [place.x + ASIDE_PX, place.y - ASIDE_PX];
    this.element.style.transform = `translate(-50%, -50%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  }

  /** The same as a share of the force that fills the ring, at most 1. */
  get share(): number {
    return this.share_;
  }

  feel(forceN: number, nowMs: number): void {
    this.sinceN_ = Math.max(this.sinceN_ ?? 0, forceN);
    this.feltMs_ = nowMs;
  }

  /** `fullN`: the force that fills the ring. */
  update(fullN: number, nowMs: number): void {
    // Between the moves of a pointer the tool rests, without force.
    if (this.sinceN_ !== null) this.shownN_ = this.sinceN_;
    else if (nowMs - this.feltMs_ > STALE_MS) this.shownN_ = 0;
    this.sinceN_ = null;
    this.share_ = Math.min(1, this.shownN_ / Math.max(fullN, 0.1));
    this.element.style.setProperty('--share', this.share_.toFixed(3));
    this.element.classList.toggle('rests', this.shownN_ < 0.005);
    setText(this.text_, `${figure(this.shownN_)} N`);
  }
}
