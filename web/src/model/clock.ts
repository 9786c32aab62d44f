// SPDX-License-Identifier: Apache-2.0
// The server's clock as seen from here, and how old what we see is. The smallest (arrival − sent) of the recent frames is the
// offset plus the least delay; ping pairs give the round trip, so the real age of a frame can be told apart from clock offset.

const WINDOW = 128;

export class ServerClock {
  private readonly differences_ = new Float64Array(WINDOW);
  private count_ = 0;
  private rttMs_ = Number.NaN;
  private offsetMs_ = Number.NaN;
  private bestRttMs_ = Infinity;

  reset(): void {
    this.count_ = 0;
    this.rttMs_ = Number.NaN;
    this.offsetMs_ = Number.NaN;
    this.bestRttMs_ = Infinity;
  }

  /** A frame with the server's time arrived. */
  arrived(localMs: number, serverUs: bigint): void {
    this.differences_[this.count_ % WINDOW] = localMs - Number(serverUs) / 1000;
    this.count_ += 1;
  }

  /** A pong came back: sent and received here, stamped there. The fastest pair gives the best offset; it ages slowly. */
  pong(sentMs: number, receivedMs: number, serverUs: bigint): void {
    const rtt = receivedMs - sentMs;
    if (!(rtt >= 0)) return;
    this.rttMs_ = Number.isNaN(this.rttMs_) ? rtt : this.rttMs_ + (rtt - this.rttMs_) * 0.3;
    this.bestRttMs_ = this.bestRttMs_ * 1.02 + 0.01;
    if (rtt <= this.bestRttMs_ || Number.isNaN(this.offsetMs_)) {
      this.bestRttMs_ = rtt;
      this.offsetMs_ = sentMs + rtt / 2 - Number(serverUs) / 1000;
    }
  }

  /** Smoothed round trip in ms; NaN until the first pong. */
  get rttMs(): number {
    return this.rttMs_;
  }

  /** A server time on the local clock, such that the fastest frames arrive at once. */
  toLocalMs(serverUs: bigint): number {
    const kept = Math.min(this.count_, WINDOW);
    let least = Infinity;
    for (let i = 0; i < kept; ++i) least = Math.min(least, this.differences_[i] as number);
    return Number(serverUs) / 1000 + (kept > 0 ? least : 0);
  }

  /** How long ago the server sent a frame, ms; NaN until the clocks are compared. */
  ageMs(localMs: number, serverUs: bigint): number {
    return Math.max(0, localMs - (Number(serverUs) / 1000 + this.offsetMs_));
  }
}

/** Events per second over the last second or so. */
export class RateMeter {
  private readonly times_ = new Float64Array(256);
  private count_ = 0;

  tick(nowMs: number): void {
    this.times_[this.count_ % this.times_.length] = nowMs;
    this.count_ += 1;
  }

  perSecond(nowMs: number): number {
    const kept = Math.min(this.count_, this.times_.length);
    let recent = 0;
    for (let i = 0; i < kept; ++i) {
      if ((this.times_[i] as number) > nowMs - 1000) recent += 1;
    }
    return recent;
  }
}
