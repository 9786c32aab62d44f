// SPDX-License-Identifier: Apache-2.0
// A line from the tool to the pointer that drags it.

import type { ReadonlySignal } from '@preact/signals';
import type { Place } from './place';

const LEAST_PX = 6;

/** The two ends of the line. */
export type Stretch = readonly [from: Place, to: Place];

/** @param ends null: the tool is at the pointer */
export function Spring({ ends }: { ends: ReadonlySignal<Stretch | null> }) {
  if (!ends.value) return null;
  const [from, to] = ends.value;
  const [x, y] = [to.x - from.x, to.y - from.y];
  const px = Math.hypot(x, y);
  if (px < LEAST_PX) return null;
  const turn = Math.atan2(y, x).toFixed(4);
  return (
    <div
      class="carve-spring"
      style={
        `width:${px.toFixed(1)}px;` +
        `transform:translate(${from.x.toFixed(1)}px, ${from.y.toFixed(1)}px) rotate(${turn}rad)`
      }
    />
  );
}
