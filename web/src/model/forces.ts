// SPDX-License-Identifier: Apache-2.0
// Force and torque magnitudes of one participant over the last seconds: what the plots draw. Samples go into a straight
// buffer that is moved down only when it is full, so that a plot gets views of it, not copies.

const CAPACITY = 4096;

export class ForceHistory {
  private readonly times_ = new Float64Array(CAPACITY);
  private readonly forces_ = new Float64Array(CAPACITY);
  private readonly torques_ = new Float64Array(CAPACITY);
  private begin_ = 0;
  private end_ = 0;

  /** @param windowS how many seconds are kept */
  constructor(private readonly windowS: number) {}

  /** Adds the magnitudes at a time in seconds; a time that does not grow is dropped. */
  push(timeS: number, forceN: number, torqueNmm: number): void {
    if (this.end_ > this.begin_ && timeS <= (this.times_[this.end_ - 1] as number)) return;
    if (this.end_ === CAPACITY) this.compact_();
    this.times_[this.end_] = timeS;
    this.forces_[this.end_] = forceN;
    this.torques_[this.end_] = torqueNmm;
    this.end_ += 1;
    while ((this.times_[this.begin_] as number) < timeS - this.windowS) this.begin_ += 1;
  }

  get count(): number {
    return this.end_ - this.begin_;
  }

  /** Views of the kept samples: time (s), force (N), torque (N·mm). Valid until the next push. */
  series(): [Float64Array, Float64Array, Float64Array] {
    const { begin_: from, end_: to } = this;
    return [this.times_.subarray(from, to), this.forces_.subarray(from, to), this.torques_.subarray(from, to)];
  }

  /** The newest magnitudes, or zeros. */
  get latest(): { forceN: number; torqueNmm: number } {
    if (this.count === 0) return { forceN: 0, torqueNmm: 0 };
    return { forceN: this.forces_[this.end_ - 1] as number, torqueNmm: this.torques_[this.end_ - 1] as number };
  }

  /** The largest magnitudes among the kept samples, N and N·mm. */
  get peak(): { forceN: number; torqueNmm: number } {
    let forceN = 0;
    let torqueNmm = 0;
    for (let i = this.begin_; i < this.end_; ++i) {
      forceN = Math.max(forceN, this.forces_[i] as number);
      torqueNmm = Math.max(torqueNmm, this.torques_[i] as number);
    }
    return { forceN, torqueNmm };
  }

  /** What the kept samples usually are while there is any force: root mean square of those above zero, N and N·mm. */
  get typical(): { forceN: number; torqueNmm: number } {
    return { forceN: this.rootMeanSquare_(this.forces_), torqueNmm: this.rootMeanSquare_(this.torques_) };
  }

  private rootMeanSquare_(values: Float64Array): number {
    let sum = 0;
    let count = 0;
    for (let i = this.begin_; i < this.end_; ++i) {
      const value = values[i] as number;
      if (value <= 0) continue;
      sum += value * value;
      count += 1;
    }
    return count > 0 ? Math.sqrt(sum / count) : 0;
  }

  private compact_(): void {
    // A window too long for the buffer loses its older half rather than its newest sample.
    const keepFrom = Math.max(this.begin_, CAPACITY / 2);
    for (const data of [this.times_, this.forces_, this.torques_]) data.copyWithin(0, keepFrom, this.end_);
    this.end_ -= keepFrom;
    this.begin_ = 0;
  }
}

/** The smallest of 1, 2, 5, 10, 20, 50 … that is not below a value: the round reference that an arrow scale shows. */
export function roundUp125(value: number): number {
  if (!(value > 0)) return 1;
  const decade = 10 ** Math.floor(Math.log10(value));
  for (const step of [1, 2, 5]) {
    if (value <= step * decade * (1 + 1e-9)) return step * decade;
  }
  return 10 * decade;
}
