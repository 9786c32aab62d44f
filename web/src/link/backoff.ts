// SPDX-License-Identifier: Apache-2.0
/** Delays between attempts to connect: doubling from 250 ms to 8 s, with a spread so that viewers do not return in step. */
export class Backoff {
  private attempt_ = 0;

  constructor(
    private readonly firstMs = 250,
    private readonly longestMs = 8000,
    private readonly random: () => number = Math.random,
  ) {}

  /** The delay before the next attempt. */
  next(): number {
    const full = Math.min(this.longestMs, this.firstMs * 2 ** this.attempt_);
    this.attempt_ += 1;
    return full * (0.75 + 0.25 * this.random());
  }

  /** A connection stood: begin with the short delay again. */
  reset(): void {
    this.attempt_ = 0;
  }

  get attempts(): number {
    return this.attempt_;
  }
}
