// SPDX-License-Identifier: Apache-2.0
// How many samples may be sent again at a time, so that the server takes them all
// (server/wire/README.md, "limits").

const AT_ONCE = 900;
const OF_LIMIT = 0.98; // the server's clock may differ a little

/** Token bucket of a connection: 900 samples at once, and then a little less than the limit. */
export class Pace {
  private tokens_ = AT_ONCE;
  private readonly perMs_: number;

  constructor(
    samplesPerS: number,
    private atMs_: number,
  ) {
    this.perMs_ = (OF_LIMIT * samplesPerS) / 1000;
  }

  /** Takes up to `wanted` tokens; returns how many. Times must not decrease. */
  take(wanted: number, nowMs: number): number {
    this.tokens_ = Math.min(AT_ONCE, this.tokens_ + (nowMs - this.atMs_) * this.perMs_);
    this.atMs_ = nowMs;
    const taken = Math.min(wanted, Math.floor(this.tokens_));
    this.tokens_ -= taken;
    return taken;
  }
}
