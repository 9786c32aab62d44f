// SPDX-License-Identifier: Apache-2.0
// Which strokes of this hand are in the server's block. A server may reject a stroke as a whole, and
// divides one during which anybody undoes. After such an event the server's list of strokes tells.

import type { Stroke } from '../model/stroke';

interface Sent {
  /** Its newest cutting sample. */
  newest: bigint;
  /** Of the block; null: the server's list is needed. */
  strokes: number | null;
}

export class StrokeCensus {
  private readonly sent_: Sent[] = [];
  private isCutting_ = false;
  private answered_ = 0n;
  private since_ = 0; // the list is known before this record,
  private counted_ = 0n; // with the strokes up to this sample
  private isAsking_ = false;

  /** `list`: the strokes of this participant that begin at a record or later, oldest first. */
  constructor(private readonly list: (since: number) => Promise<readonly Stroke[]>) {}

  /** A page that was loaded again continues: strokes of before are not counted. */
  async begin(): Promise<void> {
    if (this.sent_.length === 0) await this.ask_();
  }

  sent(sample: bigint, cuts: boolean): void {
    if (cuts && !this.isCutting_) this.sent_.push({ newest: sample, strokes: 1 });
    if (cuts) this.sent_.at(-1)!.newest = sample;
    this.isCutting_ = cuts;
  }

  answered(sample: bigint): void {
    if (sample > this.answered_) this.answered_ = sample;
    if (this.isUnclear) void this.ask_();
  }

  /** A motion was rejected, strokes were divided, or answers are missing. */
  doubt(): void {
    for (let n = this.sent_.length - 1; n >= 0; n -= 1) {
      const stroke = this.sent_[n]!;
      // A result may come a moment before the report of its rejection.
      const isOld = stroke.newest < this.answered_ && n < this.sent_.length - 1;
      if (isOld || stroke.newest <= this.counted_) break;
      stroke.strokes = null;
    }
    if (this.isUnclear) void this.ask_();
  }

  /** The page has become another participant: the strokes so far are not its own. */
  forget(): void {
    for (const stroke of this.sent_) stroke.strokes = 0;
    this.isCutting_ = false;
  }

  /** Whether the list is needed before another stroke: it would not tell them apart. */
  get isUnclear(): boolean {
    return !this.isCutting_ && this.isUnclear_();
  }

  /** Whether the newest stroke that was sent has not ended. */
  get isCutting(): boolean {
    return this.isCutting_;
  }

  /**
   * How many strokes of the block those from one number to another are, counted in the order of
   * sending, from 0. Null: not known yet; ask again.
   */
  accepted(from: number, to: number): number | null {
    const strokes = this.sent_.slice(from, to);
    if (strokes.some(({ newest }) => newest > this.answered_)) return null;
    if (strokes.some((one) => one.strokes === null)) {
      void this.ask_();
      return null;
    }
    return strokes.reduce((sum, one) => sum + one.strokes!, 0);
  }

  private isUnclear_(): boolean {
    return this.sent_.some(({ strokes }) => strokes === null);
  }

  private async ask_(): Promise<void> {
    if (this.isAsking_ || this.sent_.some(({ newest }) => newest > this.answered_)) return;
    this.isAsking_ = true;
    const { length } = this.sent_;
    const since = this.since_;
    const listed = await this.list(since).catch(() => null);
    this.isAsking_ = false;
    // A stroke that has begun since may be in the list, or not.
    if (this.sent_.length === length) this.take_(listed, since);
  }

  private take_(listed: readonly Stroke[] | null, since: number): void {
    const window = this.sent_.filter(({ newest }) => newest > this.counted_);
    const doubted = window.filter(({ strokes }) => strokes === null);
    const certain = window.length - doubted.length;
    let left = listed ? Math.max(0, listed.length - certain) : doubted.length;
    doubted.forEach((stroke, n) => {
      const isLast = n === doubted.length - 1;
      stroke.strokes = isLast ? left : Math.min(1, left);
      left -= stroke.strokes;
    });
    this.counted_ = this.sent_.at(-1)?.newest ?? 0n;
    this.since_ = 1 + Math.max(since - 1, ...(listed ?? []).map(({ id }) => id));
  }
}
