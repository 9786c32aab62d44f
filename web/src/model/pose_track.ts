// SPDX-License-Identifier: Apache-2.0
// Interpolates a tool's pose between messages. Tool states arrive 20 to 60 times a second at uneven
// intervals; drawn on arrival, a tool would stutter. The last states are kept and drawn with a
// small delay, interpolated at display rate.

import type { ToolState } from '../wire/types';

const CAPACITY = 64; // about 1 s at 60 Hz
const STRIDE = 14; // time, tip 3, axis 3, force 3, torque 3, removal rate

/** Interpolated state of a tool; an output parameter that callers reuse. */
export interface Pose {
  tip: [number, number, number];
  axis: [number, number, number];
  force: [number, number, number];
  torque: [number, number, number];
  removedRate: number;
}

export function emptyPose(): Pose {
  return { tip: [0, 0, 0], axis: [0, 0, 1], force: [0, 0, 0], torque: [0, 0, 0], removedRate: 0 };
}

/**
 * Ring buffer of the last states of one participant's tool. Allocates once. Times are local, in ms.
 */
export class PoseTrack {
  private readonly data_ = new Float64Array(CAPACITY * STRIDE);
  private pushed_ = 0;

  push(timeMs: number, state: ToolState): void {
    if (this.pushed_ > 0 && timeMs <= this.newestMs) return; // out of order
    const at = (this.pushed_ % CAPACITY) * STRIDE;
    const d = this.data_;
    d[at] = timeMs;
    d.set(state.tip_mm, at + 1);
    d.set(state.axis, at + 4);
    d.set(state.force_n, at + 7);
    d.set(state.torque_nmm, at + 10);
    d[at + 13] = state.removed_rate_mm3_per_s;
    this.pushed_ += 1;
  }

  get empty(): boolean {
    return this.pushed_ === 0;
  }

  get newestMs(): number {
    return this.empty ? -Infinity : this.data_[((this.pushed_ - 1) % CAPACITY) * STRIDE]!;
  }

  /** Removes all states, e.g. after a connection loss. */
  clear(): void {
    this.pushed_ = 0;
  }

  /**
   * Writes the state at a time to `out`: linear between the two samples around it, with the axis
   * normalized again. Before the first and after the last sample it is constant: extrapolation
   * could draw a tool inside material that it never cut. Returns false if there is no sample.
   */
  sample(timeMs: number, out: Pose): boolean {
    if (this.empty) return false;
    const oldest = Math.max(0, this.pushed_ - CAPACITY);
    let after = this.pushed_ - 1;
    while (after > oldest && this.time_(after - 1) >= timeMs) after -= 1;
    const before = Math.max(oldest, after - 1);
    const from = this.time_(before);
    const span = this.time_(after) - from;
    const part = span > 0 ? Math.min(1, Math.max(0, (timeMs - from) / span)) : 1;
    this.mix_((before % CAPACITY) * STRIDE, (after % CAPACITY) * STRIDE, part, out);
    return true;
  }

  private time_(index: number): number {
    return this.data_[(index % CAPACITY) * STRIDE]!;
  }

  private mix_(a: number, b: number, part: number, out: Pose): void {
    const d = this.data_;
    const at = (offset: number): number => {
      const from = d[a + offset]!;
      return from + (d[b + offset]! - from) * part;
    };
    for (let i = 0; i < 3; ++i) {
      out.tip[i] = at(1 + i);
      out.axis[i] = at(4 + i);
      out.force[i] = at(7 + i);
      out.torque[i] = at(10 + i);
    }
    out.removedRate = at(13);
    const length = Math.hypot(out.axis[0], out.axis[1], out.axis[2]);
    if (length > 1e-9) {
      for (let i = 0; i < 3; ++i) out.axis[i] = out.axis[i]! / length;
    }
  }
}
