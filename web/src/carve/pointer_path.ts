// SPDX-License-Identifier: Apache-2.0
// The path of a pointer between its events, which may be far apart: a smooth curve, in small steps.
// It passes through the middles between events, with the events as control points (quadratic Bézier
// curves), so that a fast circle is round. It is half a step behind until the pointer is lifted.

import type { Place } from './place';

const STEP_PX = 4;
const STEPS_MAX = 16; // of one event: each is a ray against the block

export function between(a: Place, b: Place, part: number): Place {
  const mix = (from: number, to: number): number => from + part * (to - from);
  const pressure =
    a.pressure === null || b.pressure === null ? b.pressure : mix(a.pressure, b.pressure);
  const tilt =
    a.tilt === null || b.tilt === null
      ? b.tilt
      : ([mix(a.tilt[0], b.tilt[0]), mix(a.tilt[1], b.tilt[1])] as const);
  return { x: mix(a.x, b.x), y: mix(a.y, b.y), pressure, tilt };
}

export class PointerPath {
  private middle_: Place; // where the curve has got to
  private last_: Place; // the newest event

  constructor(start: Place) {
    this.middle_ = start;
    this.last_ = start;
  }

  /** Returns the places up to the middle between the newest event and this one. */
  to(place: Place): Place[] {
    const [from, control] = [this.middle_, this.last_];
    const end = between(control, place, 0.5);
    this.middle_ = end;
    this.last_ = place;
    return steps(from, control, end);
  }

  /** Returns the places up to the newest event. */
  end(): Place[] {
    const from = this.middle_;
    this.middle_ = this.last_;
    return steps(from, between(from, this.last_, 0.5), this.last_);
  }
}

function steps(from: Place, control: Place, end: Place): Place[] {
  const length =
    Math.hypot(control.x - from.x, control.y - from.y) +
    Math.hypot(end.x - control.x, end.y - control.y);
  const count = Math.min(STEPS_MAX, Math.ceil(length / STEP_PX));
  return Array.from({ length: count }, (_, n) => {
    const part = (n + 1) / count;
    return between(between(from, control, part), between(control, end, part), part);
  });
}
