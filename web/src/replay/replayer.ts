// SPDX-License-Identifier: Apache-2.0
// A journal that a worker replays for its hashes, and for the tiles that a picture must show: one
// request after the other.

import type { TileTriangles } from '../kernel/kernel';
import { CarvingWorker } from '../local/carving_worker';
import type { FromWorker } from '../local/messages';
import type { GivenJournal, TileDigest } from '../local/program_block';

/** A record, and the hash of the state after it. */
export interface HashAt {
  record: number;
  hash: string;
}

/** The part of CarvingWorker that is used. */
export type ReplayWorker = Pick<CarvingWorker, 'open' | 'post' | 'end'>;
export type MakeReplayWorker = (heard: (message: FromWorker) => void) => ReplayWorker;

interface Waiting {
  /** Takes the answer; returns false if the message is none. */
  take: (message: FromWorker) => boolean;
  reject: (problem: Error) => void;
}

/** All functions reject with a sentence that says why. */
export class Replayer {
  private readonly worker_: ReplayWorker;
  private waiting_: Waiting | null = null;

  constructor(make: MakeReplayWorker = (heard) => new CarvingWorker(heard)) {
    this.worker_ = make((message) => this.heard_(message));
  }

  /** Reads a journal, and carves it from its beginning to a record. */
  open(journal: GivenJournal, to: number, progress?: (record: number) => void): Promise<HashAt> {
    return this.carved_(() => {
      this.worker_.open({ type: 'journal', journal, to, isSilent: true });
    }, progress);
  }

  /** Adds records to the journal; they may overlap those that it has. */
  add(spans: readonly Uint8Array<ArrayBuffer>[]): void {
    for (const span of spans) this.worker_.post({ type: 'records', span });
  }

  /** Carves on to a record. */
  carve(to: number, progress?: (record: number) => void): Promise<HashAt> {
    return this.carved_(() => this.worker_.post({ type: 'carve', to }), progress);
  }

  /** Goes to a record, back or forth, which makes the history of the journal the first time. */
  seek(motion: number): Promise<HashAt> {
    return this.carved_(() => this.worker_.post({ type: 'seek', motion }));
  }

  /** Digests of the tiles that have changed since the last call; the first time of all. */
  digests(): Promise<TileDigest[]> {
    return this.asked_(
      () => this.worker_.post({ type: 'digests' }),
      (message) => (message.type === 'digests' ? message.tiles : null),
    );
  }

  /** The mesh of a tile at the last digests(). */
  mesh(x: number, y: number): Promise<TileTriangles> {
    return this.asked_(
      () => this.worker_.post({ type: 'mesh', x, y }),
      (message) => (message.type === 'mesh' ? message.tile : null),
    );
  }

  end(): void {
    this.worker_.end();
  }

  /** @param answerIn the message's answer to it; null if it has none */
  private asked_<T>(ask: () => void, answerIn: (message: FromWorker) => T | null): Promise<T> {
    return new Promise((resolve, reject) => {
      const take = (message: FromWorker): boolean => {
        const answer = answerIn(message);
        if (answer !== null) resolve(answer);
        return answer !== null;
      };
      this.waiting_ = { take, reject };
      ask();
    });
  }

  private carved_(ask: () => void, tell?: (record: number) => void): Promise<HashAt> {
    return this.asked_(ask, (message) => {
      if (message.type !== 'carved') return null;
      const { hash, progress } = message;
      if (hash === null) tell?.(progress.carved);
      return hash === null ? null : { record: progress.carved, hash };
    });
  }

  private heard_(message: FromWorker): void {
    if (message.type === 'rejected' || message.type === 'failed')
      this.waiting_?.reject(new Error(message.reason));
    else if (this.waiting_?.take(message)) this.waiting_ = null;
  }
}
