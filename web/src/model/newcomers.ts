// SPDX-License-Identifier: Apache-2.0
// Who has just joined the session. Those who were there when the page came are not new.

import type { Participant } from './participants';

/** Somebody is new for so long. */
const NEW_MS = 6000;

export class Newcomers {
  private readonly known_ = new Set<number>();
  private newest_ = { name: '', atMs: -Infinity };

  /** Takes all who are there now, this viewer included; returns the name of the newest, or ''. */
  update(present: readonly Participant[], own: number, nowMs: number): string {
    const isFirst = this.known_.size === 0;
    for (const { info } of present) {
      if (this.known_.has(info.participant)) continue;
      this.known_.add(info.participant);
      if (!isFirst && info.participant !== own) this.newest_ = { name: info.name, atMs: nowMs };
    }
    return nowMs - this.newest_.atMs < NEW_MS ? this.newest_.name : '';
  }
}
