// SPDX-License-Identifier: Apache-2.0
// Asks the server for points in the past, one at a time: while a request is not answered, only the
// latest of those that follow is kept. So a drag along the timeline shows as many states as server
// and line can carry, and ends at the last one.

import type { Seek, StateMessage } from '../wire/types';

/** A place to look at. */
export interface Wish {
  /** A record, the present, or where the viewer is. */
  at: number | 'live' | 'here';
  /** Times the journal's time; 0: rest. */
  rate: number;
}

/** After so long an unanswered request no longer delays a newer one, which ends it. */
const PATIENCE_MS = 1000;
/** Then nothing is expected any more. */
const GIVE_UP_MS = 30_000;
/** The server allows 20 a second. */
const GAP_MS = 60;

function seekOf({ at, rate }: Wish): Seek {
  return {
    type: 'seek',
    ...(at === 'here' ? {} : { at }),
    ...(rate > 0 ? { rate } : {}),
  };
}

function answers({ at }: StateMessage, wish: Wish): boolean {
  if (wish.at === 'live' || !at) return wish.at === 'live' && !at;
  if (at.rate !== wish.rate) return false;
  if (wish.at === 'here') return true;
  return wish.rate > 0 ? at.record >= wish.at : at.record === wish.at;
}

export class Seeker {
  private next_: Wish | null = null; // not sent yet
  private sent_: Wish | null = null; // not answered yet
  private sentMs_ = -Infinity;
  private before_: StateMessage | null = null; // the state when it was sent
  private shown_: Wish | null = null; // in the past; null: the present

  constructor(private readonly send: (seek: Seek) => void) {}

  /** The last request, until it is shown; then null. */
  get wish(): Wish | null {
    return this.next_ ?? this.sent_;
  }

  /** Whether the past is shown, or about to be. */
  get looksBack(): boolean {
    return this.wish ? this.wish.at !== 'live' : this.shown_ !== null;
  }

  ask(wish: Wish, state: StateMessage | null, nowMs: number): void {
    this.next_ = wish;
    this.tick(state, nowMs);
  }

  /** The server has rejected the last request: the viewer stays where it is. */
  rejected(): void {
    this.sent_ = null;
    this.next_ = null;
  }

  /** The connection was lost: an unanswered request is sent again. Call tick() once it is back. */
  lost(): void {
    this.next_ ??= this.sent_;
    this.sent_ = null;
  }

  /** Call often, with the newest state; null between a welcome and the first one. */
  tick(state: StateMessage | null, nowMs: number): void {
    const waitedMs = nowMs - this.sentMs_;
    if (state && state !== this.before_ && this.sent_ && answers(state, this.sent_))
      this.answered_();
    if (waitedMs > GIVE_UP_MS) this.sent_ = null;
    if (state && !this.sent_) this.settle_(state);
    const isFree = this.sent_ === null || waitedMs > PATIENCE_MS;
    if (this.next_ && isFree && waitedMs >= GAP_MS) this.sendNext_(state, nowMs);
  }

  private answered_(): void {
    if (this.sent_?.at === 'live') this.shown_ = null;
    this.sent_ = null;
  }

  /** A connection that was made again shows the present: the place in the past is asked for again. */
  private settle_({ at }: StateMessage): void {
    if (at) {
      this.shown_ = { at: at.record, rate: at.rate };
    } else if (this.shown_) {
      this.next_ ??= this.shown_;
      this.shown_ = null;
    }
  }

  private sendNext_(state: StateMessage | null, nowMs: number): void {
    this.sent_ = this.next_!;
    this.next_ = null;
    this.before_ = state;
    this.sentMs_ = nowMs;
    this.send(seekOf(this.sent_));
  }
}
