// SPDX-License-Identifier: Apache-2.0
// How exact the server must be: it is told where the eye is and how small an error nobody sees, and sends far tiles coarser.

import type { Look } from '../wire/types';

/** Largest error that may be seen, in CSS pixels. */
const ERROR_PX = 0.5;
const WEAK_ERROR_PX = 1; // on phones and where drawing is slow
const SETTLED_MS = 250;
const WHILE_MOVING_MS = 1000;
const MOVED_PART = 0.08; // of the distance to what is looked at

/** The angle under which an error may appear in a picture of this height and field of view. */
export function errorRad(fovDeg: number, heightPx: number, weak: boolean): number {
  const pixelRad = (2 * Math.tan((fovDeg * Math.PI) / 360)) / heightPx;
  return (weak ? WEAK_ERROR_PX : ERROR_PX) * pixelRad;
}

/**
 * Decides when the server is to be told: once the camera has come to rest, each second while it moves on, and only if it has
 * moved by a good part of its distance since the last time.
 */
export class LookPolicy {
  private told_: Look | null = null;
  private toldMs_ = -Infinity;
  private seen_: Look | null = null;
  private changedMs_ = -Infinity;

  /** Forgets what was told: the next look is sent at once, as after a reconnection. */
  reset(): void {
    this.told_ = null;
  }

  /** Takes the look of a displayed frame; `distanceMm` is that to what is looked at. Returns the look if it is to be sent now. */
  next(look: Look, distanceMm: number, nowMs: number): Look | null {
    if (!this.seen_ || moved(this.seen_, look) > 0 || this.seen_.error_rad !== look.error_rad) {
      this.seen_ = { eye_mm: [...look.eye_mm], error_rad: look.error_rad };
      this.changedMs_ = nowMs;
    }
    if (this.told_) {
      const far = moved(this.told_, look) > MOVED_PART * distanceMm
        || Math.abs(look.error_rad - this.told_.error_rad) > MOVED_PART * this.told_.error_rad;
      if (!far) return null;
      if (nowMs - this.changedMs_ < SETTLED_MS && nowMs - this.toldMs_ < WHILE_MOVING_MS) return null;
    }
    this.told_ = this.seen_;
    this.toldMs_ = nowMs;
    return this.told_;
  }
}

function moved(a: Look, b: Look): number {
  return Math.hypot(a.eye_mm[0] - b.eye_mm[0], a.eye_mm[1] - b.eye_mm[1], a.eye_mm[2] - b.eye_mm[2]);
}
