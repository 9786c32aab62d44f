// SPDX-License-Identifier: Apache-2.0
// The cost of a headset's frames: time of the page's script, draw calls, triangles.

const KEPT = 512;

export interface FrameCost {
  frames: number;
  /** Of the last 512 frames. */
  p50Ms: number;
  p95Ms: number;
  calls: number;
  triangles: number;
}

export class FrameMeter {
  private readonly times_ = new Float64Array(KEPT);
  private frames_ = 0;
  private calls_ = 0;
  private triangles_ = 0;

  add(scriptMs: number, calls: number, triangles: number): void {
    this.times_[this.frames_ % KEPT] = scriptMs;
    this.frames_ += 1;
    this.calls_ = calls;
    this.triangles_ = triangles;
  }

  /** The counts are those of the newest frame. */
  get cost(): FrameCost {
    const times = this.times_.slice(0, Math.min(this.frames_, KEPT)).sort();
    const at = (part: number): number => times[Math.floor(part * (times.length - 1))] ?? 0;
    return {
      frames: this.frames_,
      p50Ms: at(0.5),
      p95Ms: at(0.95),
      calls: this.calls_,
      triangles: this.triangles_,
    };
  }
}
