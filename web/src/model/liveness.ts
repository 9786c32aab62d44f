// SPDX-License-Identifier: Apache-2.0
// Tells a line that stands still from a page that does: a page that was busy or suspended has
// answers in its queue that it has not read.

/** How often the page calls beat(). */
export const BEAT_MS = 100;
const STALL_MS = 300; // a beat as late as this: the page stood still
const OVERDUE_MS = 2500;

export class Liveness {
  private beatMs_ = Number.NaN;
  private stallEndMs_ = -Infinity;
  private awaiting_ = false;
  private awaitedMs_ = 0; // running time of the page

  /** Takes the time, every BEAT_MS. */
  beat(nowMs: number): void {
    const since = nowMs - this.beatMs_;
    this.beatMs_ = nowMs;
    if (since > STALL_MS) this.stallEndMs_ = nowMs;
    if (this.awaiting_ && since > 0) this.awaitedMs_ += Math.min(since, 2 * BEAT_MS);
  }

  /** A ping was sent. */
  pinged(): void {
    this.awaiting_ = true;
  }

  /**
   * The answer to a ping that was sent at `sentMs` was read. Returns whether the round trip is that
   * of the line: false if the page stood still meanwhile.
   */
  answered(sentMs: number, nowMs: number): boolean {
    this.awaiting_ = false;
    this.awaitedMs_ = 0;
    return sentMs >= this.stallEndMs_ && !(nowMs - this.beatMs_ > STALL_MS);
  }

  /** For a new connection. */
  reset(): void {
    this.awaiting_ = false;
    this.awaitedMs_ = 0;
  }

  /** How long the oldest ping has been without an answer, ms; 0 while that is not unusual. */
  get overdueMs(): number {
    return this.awaitedMs_ > OVERDUE_MS ? this.awaitedMs_ : 0;
  }
}
