// SPDX-License-Identifier: Apache-2.0
// The gestures of a hand, which undo takes back one after the other: each with its strokes and those
// of its images, by their numbers in the order of sending.

import type { Gesture } from './tool/path_queue';

/** Counts strokes of the block from one number to another; null: not known yet. */
export type Count = (from: number, to: number) => number | null;

/** Without a block that rejects some. */
export const ONE_EACH: Count = (from, to) => to - from;

/** How many strokes each gesture has in the block, the newest last. */
export interface KeptGestures {
  done: number[];
  undone: number[];
}

const KEPT_MAX = 500;
/** One of which the page knows nothing. */
const UNKNOWN: Gesture = { sent: null, known: 1 };

export class Gestures {
  private done_: Gesture[] = []; // of which something was sent
  private undone_: { gesture: Gesture; strokes: number }[] = [];
  private begun_ = 0; // strokes that were sent

  /** The next stroke is sent, of this gesture. */
  strokeOf(gesture: Gesture | undefined): void {
    const number = this.begun_++;
    this.undone_ = [];
    if (!gesture) return;
    if (!gesture.sent) this.done_.push(gesture);
    gesture.sent = { from: gesture.sent?.from ?? number, to: number + 1 };
  }

  /**
   * Undoes `only` a gesture, or the newest one of which the block has a stroke. Returns its strokes, 0
   * if there is nothing to undo, or null if that is not known yet. Nothing else may be sent meanwhile.
   */
  undo(count: Count, only: Gesture | null): number | null {
    for (;;) {
      const gesture = only ?? this.done_.at(-1) ?? UNKNOWN;
      const strokes = countOf(gesture, count);
      if (strokes === null) return null;
      this.done_ = this.done_.filter((one) => one !== gesture);
      if (strokes === 0 && !only) continue;
      this.undone_.push({ gesture, strokes });
      return strokes;
    }
  }

  /** Redoes the gesture that was undone last; returns as undo(). */
  redo(): number {
    const { gesture, strokes } = this.undone_.pop() ?? { gesture: UNKNOWN, strokes: 1 };
    this.done_.push(gesture);
    return strokes;
  }

  /** The block has refused the newest undo or redo. */
  takeBack(undone: boolean): void {
    if (undone) {
      const last = this.undone_.pop();
      if (last && last.gesture !== UNKNOWN) this.done_.push(last.gesture);
    } else {
      const gesture = this.done_.pop();
      const strokes = gesture && countOf(gesture, ONE_EACH);
      if (strokes && gesture !== UNKNOWN) this.undone_.push({ gesture, strokes });
    }
  }

  keep(count: Count): KeptGestures {
    const done = this.done_.map((one) => countOf(one, count) ?? countOf(one, ONE_EACH)!);
    const undone = this.undone_.map(({ strokes }) => strokes);
    const some = (all: number[]): number[] => all.slice(-KEPT_MAX).filter((one) => one > 0);
    return { done: some(done), undone: some(undone) };
  }

  restore({ done, undone }: KeptGestures): void {
    this.done_ = done.map((known) => ({ sent: null, known }));
    this.undone_ = undone.map((strokes) => ({ gesture: { sent: null, known: strokes }, strokes }));
  }
}

/** How many strokes of the block a gesture is; null: not known yet. */
function countOf({ sent, known }: Gesture, count: Count): number | null {
  return sent ? count(sent.from, sent.to) : known;
}
