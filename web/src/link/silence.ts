// SPDX-License-Identifier: Apache-2.0
// When a connection on which nothing comes counts as lost.

const SILENCE_MAX_MS = 10_000;

/** Only time during which the page runs counts: a page that was suspended has unread messages. */
export class Silence {
  private heardMs_ = 0;
  private tickMs_ = 0;

  /** `everyMs`: how often tick() is called while the page runs. */
  constructor(private readonly everyMs: number) {}

  /** A connection begins. */
  begin(nowMs: number): void {
    this.heardMs_ = nowMs;
    this.tickMs_ = nowMs;
  }

  /** Something has come. */
  heard(nowMs: number): void {
    this.heardMs_ = nowMs;
  }

  /** Returns whether the connection counts as lost. */
  tick(nowMs: number): boolean {
    // A late tick: read the messages that have arrived meanwhile before giving up.
    if (nowMs - this.tickMs_ > 2 * this.everyMs) this.heardMs_ = nowMs;
    this.tickMs_ = nowMs;
    return nowMs - this.heardMs_ > SILENCE_MAX_MS;
  }
}
