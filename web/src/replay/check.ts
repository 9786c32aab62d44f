// SPDX-License-Identifier: Apache-2.0
// Checks what the server says of the block: replays its journal in this browser, with the same
// kernel, and compares the state hashes. What was verified is kept, so that the next check replays
// the records after it only.

import { journalOrigin, journalRecords, replayState, storedHashes } from '../link/replay';
import type { ReplayState } from '../link/replay';
import { firstDifference } from './first_difference';
import type { Difference } from './first_difference';
import { Replayer } from './replayer';
import type { HashAt, MakeReplayWorker } from './replayer';

export type Verdict =
  | { is: 'running'; share: number }
  | { is: 'verified'; record: number; hash: string }
  /** `first`: where they part; null: not found, or not yet. */
  | {
      is: 'different';
      record: number;
      hash: string;
      serverHash: string;
      first: Difference | null;
    }
  | { is: 'failed'; reason: string };

type Tell = (verdict: Verdict) => void;

export class SessionCheck {
  /** A replay that was verified, up to a record; null: there is none. */
  private verified_: { journal: string; record: number; replayer: Replayer } | null = null;

  constructor(
    private readonly session: string,
    private readonly make?: MakeReplayWorker,
  ) {}

  /** Replays up to the present record; `tell` hears how far it is, and what came out. */
  async run(tell: Tell): Promise<void> {
    tell({ is: 'running', share: 0 });
    try {
      const state = await replayState(this.session);
      const here = await this.replayed_(state, tell);
      const verdict = compared(state, here);
      tell(verdict);
      if (verdict.is !== 'different') return;
      this.forget_();
      tell({ ...verdict, first: await this.parting_(state) });
    } catch (problem) {
      this.forget_();
      tell({ is: 'failed', reason: (problem as Error).message });
    }
  }

  private async replayed_(state: ReplayState, tell: Tell): Promise<HashAt> {
    const { record: to, journal } = state;
    const known = this.verified_;
    const goesOn = known?.journal === journal && known.record <= to;
    if (!goesOn) this.forget_();
    const after = goesOn ? known.record : 0;
    const spans = await journalRecords(this.session, journal, after, to);
    const progress = (record: number): void =>
      tell({ is: 'running', share: (record - after) / Math.max(1, to - after) });
    const replayer = goesOn ? known.replayer : new Replayer(this.make);
    this.verified_ = { journal, record: to, replayer };
    if (goesOn) {
      replayer.add(spans);
      return replayer.carve(to, progress);
    }
    const origin = await journalOrigin(this.session, journal);
    return replayer.open({ origin, spans }, to, progress);
  }

  private async parting_({ journal, record, state_hash }: ReplayState): Promise<Difference> {
    const { session } = this;
    const replayer = new Replayer(this.make);
    try {
      const origin = await journalOrigin(session, journal);
      const spans = await journalRecords(session, journal, 0, record);
      await replayer.open({ origin, spans }, 0);
      const server = {
        stored: (first: number, last: number) => storedHashes(session, journal, first, last),
        replayed: async (at: number) => (await replayState(session, at)).state_hash,
      };
      return await firstDifference(server, replayer, { record, hash: state_hash });
    } finally {
      replayer.end();
    }
  }

  private forget_(): void {
    this.verified_?.replayer.end();
    this.verified_ = null;
  }
}

/** What a replay says that has reached a record with a hash. */
export function compared(state: ReplayState, { record, hash }: HashAt): Verdict {
  if (record === state.record && hash === state.state_hash) return { is: 'verified', record, hash };
  return { is: 'different', record, hash, serverHash: state.state_hash, first: null };
}
