// SPDX-License-Identifier: Apache-2.0
// A long text by its lines, without a string for each.

export class LineIndex {
  /** Where each line begins; one more entry than lines. */
  private readonly starts_: Uint32Array;
  readonly count: number;

  constructor(private readonly text: string) {
    let count = 1;
    for (let at = text.indexOf('\n'); at >= 0; at = text.indexOf('\n', at + 1)) count += 1;
    if (text.endsWith('\n')) count -= 1;
    this.count = Math.max(count, 1);
    this.starts_ = new Uint32Array(this.count + 1);
    let at = 0;
    for (let n = 1; n <= this.count; n += 1) {
      const end = text.indexOf('\n', at);
      at = end < 0 ? text.length + 1 : end + 1;
      this.starts_[n] = at;
    }
  }

  /** Line `number`, from 1, without its end; empty outside of the text. */
  line(number: number): string {
    if (number < 1 || number > this.count) return '';
    const line = this.text.slice(this.starts_[number - 1], this.starts_[number]! - 1);
    return line.endsWith('\r') ? line.slice(0, -1) : line;
  }
}

/** The rows of a list that are in view, from 0, `past` excluded, with some more on both sides. */
export function rowsInView(
  scrollTop: number,
  height: number,
  rowHeight: number,
  count: number,
  more: number,
): { first: number; past: number } {
  const first = Math.max(0, Math.floor(scrollTop / rowHeight) - more);
  const past = Math.min(count, Math.ceil((scrollTop + height) / rowHeight) + more);
  return { first: Math.min(first, count), past: Math.max(past, 0) };
}
