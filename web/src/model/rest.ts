// SPDX-License-Identifier: Apache-2.0
// Decides when the tiles are to be exact. Levels of detail serve a picture that moves: one that
// rests shows the block as it is.

import type { Vec3 } from '../wire/types';
import { MOVED_FRACTION } from './look_policy';

const REST_MS = 2000;
/** An eye no farther from its place has not moved: damping ends slowly. Of the distance. */
const STILL_FRACTION = 1e-5;

/** A displayed frame, for Rest. */
export interface RestFrame {
  eyeMm: Vec3;
  /** From the eye to the camera's target. */
  distanceMm: number;
  /** How many motions the block has. */
  motions: number;
  /** Whether the picture moves smoothly even with exact tiles: it then keeps them. */
  isFast: boolean;
}

export class Rest {
  private eyeMm_: Vec3 = [NaN, NaN, NaN];
  private motions_ = -1;
  private sinceMs_ = 0;
  private isResting_ = false;

  /**
   * Takes a displayed frame. Returns true once neither the eye nor the block has moved for two
   * seconds, and on until the eye has left its place by a significant fraction of its distance.
   */
  take({ eyeMm, distanceMm, motions, isFast }: RestFrame, nowMs: number): boolean {
    const movedMm = Math.hypot(
      eyeMm[0] - this.eyeMm_[0],
      eyeMm[1] - this.eyeMm_[1],
      eyeMm[2] - this.eyeMm_[2],
    );
    if (this.isResting_) {
      if (isFast || movedMm <= MOVED_FRACTION * distanceMm) return true;
      this.isResting_ = false;
    }
    if (movedMm <= STILL_FRACTION * distanceMm && motions === this.motions_) {
      this.isResting_ = nowMs - this.sinceMs_ >= REST_MS;
    } else {
      this.eyeMm_ = [...eyeMm];
      this.motions_ = motions;
      this.sinceMs_ = nowMs;
    }
    return this.isResting_;
  }

  /** Forgets the place, as after a reconnection. */
  reset(): void {
    this.isResting_ = false;
    this.motions_ = -1;
  }
}
