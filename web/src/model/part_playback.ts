// SPDX-License-Identifier: Apache-2.0
// Shows a part of the journal record by record in a time that suits a viewer, whatever time the cuts
// took: a program at full speed is carved in an instant.

const MS_PER_RECORD = 250;
const LEAST_MS = 2000;
const MOST_MS = 20_000;

export class PartPlayback {
  private readonly durationMs_: number;

  /** @param first, last records of the part, both of it */
  constructor(
    private readonly first: number,
    private readonly last: number,
    private readonly beginMs: number,
  ) {
    const wishedMs = (last - first + 1) * MS_PER_RECORD;
    this.durationMs_ = Math.min(MOST_MS, Math.max(LEAST_MS, wishedMs));
  }

  /** The record to be shown: at the beginning the one before the part, at the end its last one. */
  recordAt(nowMs: number): number {
    const share = Math.min(1, Math.max(0, (nowMs - this.beginMs) / this.durationMs_));
    return this.first - 1 + Math.round(share * (this.last - this.first + 1));
  }

  isOver(nowMs: number): boolean {
    return nowMs - this.beginMs >= this.durationMs_;
  }
}
