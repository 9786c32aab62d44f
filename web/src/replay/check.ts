// SPDX-License-Identifier: Apache-2.0
// Verifies the server's state and picture of the block: replays its journal in this browser, with
// the same kernel, and compares the state hashes, then the tiles that the page displays. Verified
// records are kept, so that the next check replays only the records after them.

import { journalOrigin, journalRecords, replayState, storedHashes } from '../link/replay';
import type { ReplayState } from '../link/replay';
import { PictureCheck } from './picture_check';
import { firstDifference } from './first_difference';
import type { Difference } from './first_difference';
import { Replayer } from './replayer';
import type { HashAt, MakeReplayWorker } from './replayer';
import type { ShownPicture } from './shown_picture';

export type Verdict =
  | { is: 'running'; share: number }
  /** The state is verified, and not yet the picture, which is not of a state at rest, or late. */
  | { is: 'waiting'; record: number; isBehind: boolean }
  /** The state is verified, and the picture does not show it. */
  | { is: 'unseen'; record: number; tiles: number }
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

/** How often a picture is looked at that does not show the state yet, and how often that may be. */
const LOOK_EVERY_MS = 250;
const LOOKS_MAX = 20;

export class SessionCheck {
  /** A replay that was verified, up to a record; null: there is none. */
  private verified_: {
    journal: string;
    record: number;
    replayer: Replayer;
    picture: PictureCheck;
  } | null = null;

  /** @param shown null where there is no picture: then the state alone is checked */
  constructor(
    private readonly session: string,
    private readonly shown: () => ShownPicture | null,
    private readonly make?: MakeReplayWorker,
    private readonly pause = (ms: number): Promise<void> =>
      new Promise((resolve) => setTimeout(resolve, ms)),
  ) {}

  /** Replays up to the present record; `tell` hears how far it is, and what came out. */
  async run(tell: Tell): Promise<void> {
    tell({ is: 'running', share: 0 });
    try {
      let looks = 0;
      for (;;) {
        const state = await replayState(this.session);
        const verdict = compared(state, await this.replayed_(state, tell));
        if (verdict.is === 'different') {
          tell(verdict);
          this.forget_();
          tell({ ...verdict, first: await this.parting_(state) });
          return;
        }
        const seen = await this.seen_(verdict, tell);
        if (seen.is === 'verified' || (seen.is === 'unseen' && ++looks >= LOOKS_MAX)) {
          tell(seen);
          return;
        }
        await this.pause(LOOK_EVERY_MS);
      }
    } catch (problem) {
      this.forget_();
      tell({ is: 'failed', reason: (problem as Error).message });
    }
  }

  /** Whether the picture shows a state that is verified, once it shows one at rest. */
  private async seen_(verdict: Verdict & { is: 'verified' }, tell: Tell): Promise<Verdict> {
    const { record, hash } = verdict;
    for (;;) {
      const shown = this.shown();
      if (!shown) return verdict;
      if (shown.hash === hash) {
        const tiles = await this.verified_!.picture.differing(shown);
        return tiles === 0 ? verdict : { is: 'unseen', record, tiles };
      }
      tell({ is: 'waiting', record, isBehind: shown.isBehind });
      await this.pause(LOOK_EVERY_MS);
      // Another state at rest: it is replayed first.
      if (this.shown()?.hash) return { is: 'waiting', record, isBehind: false };
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
    const picture = goesOn ? known.picture : new PictureCheck(replayer);
    this.verified_ = { journal, record: to, replayer, picture };
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

/** A replay's message on reaching a record with a hash. */
export function compared(
  state: ReplayState,
  { record, hash }: HashAt,
): Verdict & { is: 'verified' | 'different' } {
  if (record === state.record && hash === state.state_hash) return { is: 'verified', record, hash };
  return { is: 'different', record, hash, serverHash: state.state_hash, first: null };
}
