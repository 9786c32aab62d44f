// SPDX-License-Identifier: Apache-2.0
// A line from the tool to the pointer that drags it.

import { h } from '../ui/dom';
import type { Place } from './place';

const LEAST_PX = 6;

export class Spring {
  readonly element = h('div', { class: 'carve-spring', hidden: '' });

  /** Null: the tool is at the pointer. */
  update(ends: readonly [Place, Place] | null): void {
    const [from, to] = ends ?? [];
    const px = from && to ? Math.hypot(to.x - from.x, to.y - from.y) : 0;
    this.element.hidden = px < LEAST_PX;
    if (!from || !to || this.element.hidden) return;
    const turn = Math.atan2(to.y - from.y, to.x - from.x);
    this.element.style.width = `${px.toFixed(1)}px`;
    this.element.style.transform = `translate(${from.x.toFixed(1)}px, ${from.y.toFixed(1)}px) rotate(${turn.toFixed(4)}rad)`;
  }
}
