// SPDX-License-Identifier: Apache-2.0
// The cutting force as drag: the tool follows the pointer's path on a spring, and the harder it cuts,
// the later it comes.
//
// The law: a spring pulls the tool along the path, and a damper in proportion to the cutting force
// holds it back; the tool has no mass. With the lag L, the length of the path ahead of the tool, and
// the time constant T of spring and damper, dL/dt = v − L / T: in time dt the tool goes 1 − e^(−dt/T)
// of that path. T is the greatest one of the strength times the force, as a share of the one that fills
// the gauge's ring; it follows the force within SMOOTH_MS. The tool never turns back, never passes the
// pointer, is behind a steady one by v T, never by more than the spring's greatest length, and at the
// pointer again some 0.2 s after the force has ended. Without force it is at the pointer at once.
// The path is the pointer's, so the cut has the same shape at any strength.

import { lerp, slerp } from './tool/vectors';
import type { Pose } from './tool/path_queue';
import { between } from './pointer_path';
import type { Place } from './place';

export type DragStrength = 'off' | 'light' | 'strong';
export const DRAG_STRENGTHS: readonly DragStrength[] = ['off', 'light', 'strong'];

/** Of each strength: the greatest time constant, and the greatest lag in pixels of the pointer's path. */
const SPRINGS: Record<DragStrength, { mostMs: number; longestPx: number }> = {
  off: { mostMs: 0, longestPx: 0 },
  light: { mostMs: 80, longestPx: 30 },
  strong: { mostMs: 300, longestPx: 120 },
};
const SMOOTH_MS = 40;
const RIGID_MS = 1; // a time constant below this is none
const THERE_PX = 0.25; // so near, the tool is there

/** A place of the pointer, and the pose of the tool there. */
export interface DragStep {
  place: Place;
  pose: Pose;
  /** The surface has a gap here: the tool is lifted, and begins again from this pose. */
  hop?: Pose;
}

export class Drag {
  strength: DragStrength = 'off';
  private at_: DragStep | null = null; // the tool
  private ahead_: DragStep[] = []; // up to the pointer
  private constantMs_ = 0;
  private sinceMs_ = 0;

  /** A stroke begins: the tool is at the pointer. */
  begin(step: DragStep, nowMs: number): void {
    this.at_ = step;
    this.ahead_ = [];
    this.constantMs_ = 0;
    this.sinceMs_ = nowMs;
  }

  /** The pointer has got there. */
  pull(step: DragStep): void {
    this.ahead_.push(step);
  }

  /** The length of the path between tool and pointer, CSS pixels. */
  get lagPx(): number {
    let px = 0;
    let from = this.at_;
    for (const step of this.ahead_) {
      px += from ? apart(from, step) : 0;
      from = step;
    }
    return px;
  }

  /** Between tool and pointer; null: nothing is. */
  get stretch(): readonly [Place, Place] | null {
    const pointer = this.ahead_.at(-1);
    return this.at_ && pointer ? [this.at_.place, pointer.place] : null;
  }

  /** Whether the tool is held back. */
  get isSlow(): boolean {
    return this.strength !== 'off' && this.constantMs_ >= RIGID_MS;
  }

  /**
   * Returns the steps of the tool since the last call, in order. `share`: the force on it, of the one
   * that fills the ring.
   */
  follow(share: number, nowMs: number): DragStep[] {
    const spentMs = Math.max(0, nowMs - this.sinceMs_);
    this.sinceMs_ = nowMs;
    const { mostMs, longestPx } = SPRINGS[this.strength];
    const aimMs = mostMs * Math.min(1, Math.max(0, share));
    this.constantMs_ += (aimMs - this.constantMs_) * (1 - Math.exp(-spentMs / SMOOTH_MS));
    if (!this.isSlow) return this.end();
    const lag = this.lagPx;
    const rest = lag * Math.exp(-spentMs / this.constantMs_);
    return rest < THERE_PX ? this.end() : this.walk_(lag - Math.min(rest, longestPx));
  }

  /** The rest of the path at once. */
  end(): DragStep[] {
    const steps = this.ahead_;
    this.ahead_ = [];
    this.at_ = steps.at(-1) ?? this.at_;
    return steps;
  }

  private walk_(px: number): DragStep[] {
    const steps: DragStep[] = [];
    let left = px;
    while (left > 0 && this.at_) {
      const [next] = this.ahead_;
      if (!next) break;
      const length = next.hop ? 0 : apart(this.at_, next);
      if (length <= left) {
        this.ahead_.shift();
        this.at_ = next;
      } else this.at_ = inside(this.at_, next, left / length);
      left -= length;
      steps.push(this.at_);
    }
    return steps;
  }
}

function apart({ place: a }: DragStep, { place: b }: DragStep): number {
  return Math.hypot(b.x - a.x, b.y - a.y);
}

function inside(a: DragStep, b: DragStep, part: number): DragStep {
  const pose = {
    tip: lerp(a.pose.tip, b.pose.tip, part),
    axis: slerp(a.pose.axis, b.pose.axis, part),
  };
  return { place: between(a.place, b.place, part), pose };
}
