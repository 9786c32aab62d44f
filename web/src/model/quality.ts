// SPDX-License-Identifier: Apache-2.0
// Keeps drawing fluent on weak devices: while the picture moves, the pixel ratio steps down when frames are slow and back up
// when they are quick; once it stands still, one full-quality picture is drawn.

const LEVELS = [1, 0.8, 0.62, 0.48, 0.36, 0.28] as const;
const SLOW_MS = 30;
const QUICK_MS = 13;
const SAMPLES_DOWN = 6;
const SAMPLES_UP = 90;
const CRAWL_AFTER = 30; // slow frames at the lowest ratio
const CRAWL_MS = 140;

export class Quality {
  private level_: number;
  private slow_ = 0;
  private quick_ = 0;
  private crawling_ = false;

  /**
   * @param fullRatio the pixel ratio of a still picture
   * @param weak begin low, where it is known beforehand that drawing is slow
   */
  constructor(private readonly fullRatio: number, weak = false) {
    this.level_ = weak ? LEVELS.length - 1 : 0;
  }

  /** Reports the time between two drawn frames. Returns true if the ratio changed. */
  frame(milliseconds: number): boolean {
    if (milliseconds > 1000) return false; // the tab slept
    this.slow_ = milliseconds > SLOW_MS ? this.slow_ + 1 : 0;
    this.quick_ = milliseconds < QUICK_MS ? this.quick_ + 1 : 0;
    if (this.slow_ >= SAMPLES_DOWN && this.level_ < LEVELS.length - 1) return this.step_(1);
    if (this.slow_ >= CRAWL_AFTER) this.crawling_ = true;
    if (this.quick_ >= SAMPLES_UP && this.level_ > 0) return this.step_(-1);
    return false;
  }

  /** Pixel ratio for a moving picture. */
  get movingRatio(): number {
    return this.fullRatio * (LEVELS[this.level_] as number);
  }

  /** Least time between two frames: on a device that cannot keep up even so, the rest of the page needs room to breathe. */
  get pauseMs(): number {
    return this.crawling_ ? CRAWL_MS : 0;
  }

  /** The picture stood still: what made it slow may be over. */
  rested(): void {
    this.crawling_ = false;
    this.slow_ = 0;
  }

  get stillRatio(): number {
    return this.fullRatio;
  }

  /** Weak devices also go without the moving shadow. */
  get shadowsWhileMoving(): boolean {
    return this.level_ < 3;
  }

  private step_(by: number): boolean {
    this.level_ += by;
    this.slow_ = 0;
    this.quick_ = 0;
    return true;
  }
}
