// SPDX-License-Identifier: Apache-2.0
// History of one participant's force and torque magnitudes over the last seconds, for the plots.
// Samples are appended to a contiguous buffer, which is compacted only when full, so that plots get
// views instead of copies.

const CAPACITY = 4096;

export class ForceHistory {
  private readonly times_ = new Float64Array(CAPACITY);
  private readonly forces_ = new Float64Array(CAPACITY);
  private readonly torques_ = new Float64Array(CAPACITY);
  private begin_ = 0;
  private end_ = 0;

  /** @param windowS length of the kept history, s */
  constructor(private readonly windowS: number) {}

  /** Appends the magnitudes at `timeS`. Ignores a sample that is not newer than the last one. */
  push(timeS: number, forceN: number, torqueNmm: number): void {
    if (this.end_ > this.begin_ && timeS <= this.times_[this.end_ - 1]!) return;
    if (this.end_ === CAPACITY) this.compact_();
    this.times_[this.end_] = timeS;
    this.forces_[this.end_] = forceN;
    this.torques_[this.end_] = torqueNmm;
    this.end_ += 1;
    while (this.times_[this.begin_]! < timeS - this.windowS) this.begin_ += 1;
  }

  /**
   * Drops the samples older than the window at `timeS`. Needed for a participant who sends none.
   */
  forget(timeS: number): void {
    while (this.begin_ < this.end_ && this.times_[this.begin_]! < timeS - this.windowS)
      this.begin_ += 1;
  }

  get count(): number {
    return this.end_ - this.begin_;
  }

  /**
   * Returns views of the kept samples: time (s), force (N), torque (N·mm). Valid until the next
   * push.
   */
  series(): [Float64Array, Float64Array, Float64Array] {
    const { begin_: from, end_: to } = this;
    return [
      this.times_.subarray(from, to),
      this.forces_.subarray(from, to),
      this.torques_.subarray(from, to),
    ];
  }

  /** The newest magnitudes; zeros if there is no sample. */
  get latest(): { forceN: number; torqueNmm: number } {
    if (this.count === 0) return { forceN: 0, torqueNmm: 0 };
    return { forceN: this.forces_[this.end_ - 1]!, torqueNmm: this.torques_[this.end_ - 1]! };
  }

  /** Maxima of the kept samples, N and N·mm. */
  get peak(): { forceN: number; torqueNmm: number } {
    let forceN = 0;
    let torqueNmm = 0;
    for (let i = this.begin_; i < this.end_; ++i) {
      forceN = Math.max(forceN, this.forces_[i]!);
      torqueNmm = Math.max(torqueNmm, this.torques_[i]!);
    }
    return { forceN, torqueNmm };
  }

  /** RMS of the non-zero samples, N and N·mm. */
  get typical(): { forceN: number; torqueNmm: number } {
    return {
      forceN: this.rootMeanSquare_(this.forces_),
      torqueNmm: this.rootMeanSquare_(this.torques_),
    };
  }

  private rootMeanSquare_(values: Float64Array): number {
    let sum = 0;
    let count = 0;
    for (let i = this.begin_; i < this.end_; ++i) {
      const value = values[i]!;
      if (value <= 0) continue;
      sum += value * value;
      count += 1;
    }
    return count > 0 ? Math.sqrt(sum / count) : 0;
  }

  private compact_(): void {
    // If the window does not fit into the buffer, drop the older half instead of new samples.
    const keepFrom = Math.max(this.begin_, CAPACITY / 2);
    for (const data of [this.times_, this.forces_, this.torques_])
      data.copyWithin(0, keepFrom, this.end_);
    this.end_ -= keepFrom;
    this.begin_ = 0;
  }
}
