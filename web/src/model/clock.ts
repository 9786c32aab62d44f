// SPDX-License-Identifier: Apache-2.0
// Estimates the server's clock and the age of received frames. The smallest (arrival − sent) of the
// recent frames is the clock offset plus the shortest delay. Ping pairs give the round trip, and
// with it the clock offset alone, hence a frame's true age.

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

  /** Records the arrival of a frame that carries the server's time. */
  arrived(localMs: number, serverUs: bigint): void {
    this.differences_[this.count_ % WINDOW] = localMs - Number(serverUs) / 1000;
    this.count_ += 1;
  }

  /**
   * Records a ping pair: sent and received on the local clock, answered at `serverUs`. The pair
   * with the shortest round trip gives the best offset; its round trip is raised by 2 % with each
   * pair, so that the estimate is renewed.
   */
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

  /**
   * Maps a server time to the local clock, in ms, so that the fastest frames map to their arrival
   * time.
   */
  toLocalMs(serverUs: bigint): number {
    const kept = Math.min(this.count_, WINDOW);
    let least = Infinity;
    for (let i = 0; i < kept; ++i) least = Math.min(least, this.differences_[i]!);
    return Number(serverUs) / 1000 + (kept > 0 ? least : 0);
  }

  /** Returns how long ago the server sent a frame, ms; NaN until the first pong. */
  ageMs(localMs: number, serverUs: bigint): number {
    return Math.max(0, localMs - (Number(serverUs) / 1000 + this.offsetMs_));
  }
}

/** Counts the events of the last second, up to 256. */
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
      if (this.times_[i]! > nowMs - 1000) recent += 1;
    }
    return recent;
  }
}
