// SPDX-License-Identifier: Apache-2.0
// Adapts the pixel ratio to the speed of the device: while the picture moves, the ratio steps down
// when frames are slow and up again when they are fast. A still picture is drawn once at full
// quality.

/** Pictures have at most so many pixels for a CSS pixel. */
const RATIO_MAX = 2;
const LEVELS = [1, 0.8, 0.62, 0.48, 0.36, 0.28] as const;
const SLOW_MS = 30;
const FAST_MS = 13;
const SAMPLES_DOWN = 6;
const SAMPLES_UP = 90;
const THROTTLE_AFTER = 30; // consecutive slow frames at the lowest ratio
const THROTTLED_PAUSE_MS = 60; // at most 16 pictures a second
const STILL_AFTER_MS = 260;
const STILL_AFTER_MAX_MS = 2080;
const STILL_SEEN_MS = 1000;
const SLOW_LEVEL = 3; // of the levels, from which on a device is slow
const SHADOWS_EVERY_MS = 2000;

/** Returns how many pixels a still picture has for each CSS pixel of a screen. */
export function drawnRatio(devicePixelRatio: number): number {
  return Math.min(RATIO_MAX, devicePixelRatio || 1);
}

export class Quality {
  private level_: number;
  private slow_ = 0;
  private fast_ = 0;
  private throttled_ = false;
  private stillAfterMs_ = STILL_AFTER_MS;
  private shadowsMs_ = 0;

  /**
   * @param fullRatio the pixel ratio of a still picture
   * @param weak start at the lowest ratio, for devices known to draw slowly
   */
  constructor(
    private readonly fullRatio: number,
    weak = false,
  ) {
    this.level_ = weak ? LEVELS.length - 1 : 0;
  }

  /** Takes the time between two drawn frames. Returns true if the ratio changed. */
  frame(milliseconds: number): boolean {
    if (milliseconds > 1000) return false; // the tab was in the background
    this.slow_ = milliseconds > SLOW_MS ? this.slow_ + 1 : 0;
    this.fast_ = milliseconds < FAST_MS ? this.fast_ + 1 : 0;
    if (this.slow_ >= SAMPLES_DOWN && this.level_ < LEVELS.length - 1) return this.step_(1);
    if (this.slow_ >= THROTTLE_AFTER) this.throttled_ = true;
    if (this.fast_ >= SAMPLES_UP && this.level_ > 0) return this.step_(-1);
    return false;
  }

  /** Pixel ratio for a moving picture. */
  get movingRatio(): number {
    return this.fullRatio * (LEVELS[this.level_] as number);
  }

  /**
   * Minimum time between two frames, ms: leaves time for the rest of the page where even the lowest
   * ratio is slow.
   */
  get pauseMs(): number {
    return this.throttled_ ? THROTTLED_PAUSE_MS : 0;
  }

  /** Ends the throttling after the picture stood still, because its cause may be gone. */
  rested(): void {
    this.throttled_ = false;
    this.slow_ = 0;
  }

  get stillRatio(): number {
    return this.fullRatio;
  }

  /** Time without a change after which a still picture is drawn, ms. */
  get stillAfterMs(): number {
    return this.stillAfterMs_;
  }

  /**
   * Takes for how long the still picture was shown until the next change. One that was soon
   * replaced was not worth its time, which moving ones could have had: the next one waits longer.
   */
  moved(milliseconds: number): void {
    this.stillAfterMs_ =
      milliseconds < STILL_SEEN_MS
        ? Math.min(4 * this.stillAfterMs_, STILL_AFTER_MAX_MS)
        : STILL_AFTER_MS;
  }

  /** Whether a moving picture is drawn as quickly as it can be. */
  get isSlow(): boolean {
    return this.level_ >= SLOW_LEVEL;
  }

  /** Whether shadows that have changed are drawn with a moving picture: now and then where slow. */
  takesShadows(nowMs: number): boolean {
    const takes = !this.isSlow || nowMs - this.shadowsMs_ >= SHADOWS_EVERY_MS;
    if (takes) this.shadowsMs_ = nowMs;
    return takes;
  }

  private step_(by: number): boolean {
    this.level_ += by;
    this.slow_ = 0;
    this.fast_ = 0;
    return true;
  }
}
