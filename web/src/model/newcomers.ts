// SPDX-License-Identifier: Apache-2.0
// Who has just joined the session. Those who were there when the page came are not new.

import type { Participant } from './participants';

/** Somebody is new for so long. */
const NEW_MS = 6000;

export class Newcomers {
  private readonly known_ = new Set<number>();
  private newest_ = { name: '', atMs: -Infinity };

  /**
   * Takes all who are there now; returns the name of the newest, or ''. `isSelf`: this viewer and its
   * hand, neither of which is new to it.
   */
  update(
    present: readonly Participant[],
    isSelf: (participant: Participant) => boolean,
    nowMs: number,
  ): string {
    const isFirst = this.known_.size === 0;
    for (const one of present) {
      const { participant, name } = one.info;
      if (this.known_.has(participant)) continue;
      this.known_.add(participant);
      if (!isFirst && !isSelf(one)) this.newest_ = { name, atMs: nowMs };
    }
    return nowMs - this.newest_.atMs < NEW_MS ? this.newest_.name : '';
  }
}
