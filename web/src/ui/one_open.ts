// SPDX-License-Identifier: Apache-2.0
// Parts of the page of which one at a time is open, because they lie on each other or take the same
// pointer: the panels at the side, and carving.

/** Closes a part; also identifies it. */
export type Close = () => void;

export class OneOpen {
  private close_: Close | null = null;

  /** A part opens: the one that was open closes. */
  opens(close: Close): void {
    const before = this.close_;
    this.close_ = close;
    before?.();
  }

  /** A part has closed. */
  closed(close: Close): void {
    if (this.close_ === close) this.close_ = null;
  }
}
