// SPDX-License-Identifier: Apache-2.0
// The text of a program, the line that is carved, and a marked line.

import { batch, signal } from '@preact/signals';
import { LineIndex } from '../../model/line_index';

export interface Mark {
  line: number;
  /** The word in it; empty: the line. */
  word: string;
  /** Nothing is wrong there: its place is marked in the picture. */
  isPlace?: boolean;
}

/** A request to bring a line into view. */
export interface Scroll {
  line: number;
  /** Only if it is not in view yet. */
  ifHidden: boolean;
}

const NO_MARK: Mark = { line: 0, word: '' };

export class TextState {
  readonly lines = signal(new LineIndex(''));
  /** The line that is being carved; 0: none. */
  readonly live = signal(0);
  readonly mark = signal(NO_MARK);
  /** Whether the text moves with the live line; scrolling ends that. */
  readonly follows = signal(true);
  /** Counts the requests to bring the whole text into view. */
  readonly reveals = signal(0);
  /** The newest request; each is another object. */
  readonly scroll = signal<Scroll>({ line: 1, ifHidden: false });

  show(text: string): void {
    batch(() => {
      this.lines.value = new LineIndex(text);
      this.mark.value = NO_MARK;
      this.live.value = 0;
      this.scroll_(1);
    });
  }

  setLive(line: number): void {
    if (line === this.live.peek()) return;
    batch(() => {
      this.live.value = line;
      if (this.follows.peek() && line > 0) this.scroll_(line);
    });
  }

  /** Marks a line, e.g. of an error, and brings it into view unless it is. */
  markLine(mark: Mark): void {
    batch(() => {
      this.mark.value = mark;
      this.follow(false);
      this.scroll_(mark.line, true);
    });
  }

  follow(follows: boolean): void {
    batch(() => {
      if (follows && this.live.peek() > 0) this.scroll_(this.live.peek());
      this.follows.value = follows;
    });
  }

  /** Brings the whole text into view. */
  reveal(): void {
    this.reveals.value += 1;
  }

  private scroll_(line: number, ifHidden = false): void {
    this.scroll.value = { line, ifHidden };
  }
}
