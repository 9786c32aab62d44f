// SPDX-License-Identifier: Apache-2.0
// Decides when to send 'look' messages: the camera position and the acceptable error, by which the
// server picks each tile's level.

import type { Look } from '../wire/types';
import { FOV_DEG } from './fit';
import { drawnRatio } from './quality';

/** Acceptable surface error on screen, in pixels of the picture. */
const ERROR_PX = 0.5;
const SETTLED_MS = 250;
const WHILE_MOVING_MS = 1000;
/** An eye has moved that left its place by more, of the distance to the camera's target. */
export const MOVED_FRACTION = 0.08;

/**
 * Returns the acceptable error as an angle, for a picture of this height in CSS pixels that is drawn
 * with `pixelRatio` pixels for each.
 */
export function errorRad(heightPx: number, pixelRatio: number): number {
  const pixelRad = (2 * Math.tan((FOV_DEG * Math.PI) / 360)) / (heightPx * drawnRatio(pixelRatio));
  return ERROR_PX * pixelRad;
}

/**
 * Sends once the camera has come to rest and every second while it keeps moving, but only if it has
 * moved by a significant fraction of its distance, or the error has changed, since the last
 * message.
 */
export class LookPolicy {
  private sent_: Look | null = null;
  private sentMs_ = -Infinity;
  private latest_: Look | null = null;
  private changedMs_ = -Infinity;

  /** Makes the next call of next() send, as needed after a reconnection. */
  reset(): void {
    this.sent_ = null;
  }

  /**
   * Takes the look of a displayed frame and the camera's distance to its target. Returns the look
   * if it must be sent now.
   */
  next(look: Look, distanceMm: number, nowMs: number): Look | null {
    if (
      !this.latest_ ||
      moved(this.latest_, look) > 0 ||
      this.latest_.error_rad !== look.error_rad
    ) {
      this.latest_ = { eye_mm: [...look.eye_mm], error_rad: look.error_rad };
      this.changedMs_ = nowMs;
    }
    if (this.sent_) {
      const changed =
        moved(this.sent_, look) > MOVED_FRACTION * distanceMm ||
        Math.abs(look.error_rad - this.sent_.error_rad) > MOVED_FRACTION * this.sent_.error_rad;
      if (!changed) return null;
      if (nowMs - this.changedMs_ < SETTLED_MS && nowMs - this.sentMs_ < WHILE_MOVING_MS)
        return null;
    }
    this.sent_ = this.latest_;
    this.sentMs_ = nowMs;
    return this.sent_;
  }
}

function moved(a: Look, b: Look): number {
  return Math.hypot(
    a.eye_mm[0] - b.eye_mm[0],
    a.eye_mm[1] - b.eye_mm[1],
    a.eye_mm[2] - b.eye_mm[2],
  );
}
