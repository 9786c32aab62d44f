// SPDX-License-Identifier: Apache-2.0
/**
 * Delays between connection attempts: doubling from 250 ms to 2 s, each shortened by up to 25 % at
 * random, so that many viewers do not reconnect at the same instant.
 */
export class Backoff {
  private attempt_ = 0;

  constructor(
    private readonly firstMs = 250,
    private readonly longestMs = 2000,
    private readonly random: () => number = Math.random,
  ) {}

  /** Returns the delay before the next attempt, ms. */
  next(): number {
    const full = Math.min(this.longestMs, this.firstMs * 2 ** this.attempt_);
    this.attempt_ += 1;
    return full * (0.75 + 0.25 * this.random());
  }

  /** Starts again with the shortest delay, after a connection succeeded. */
  reset(): void {
    this.attempt_ = 0;
  }

  get attempts(): number {
    return this.attempt_;
  }
}
