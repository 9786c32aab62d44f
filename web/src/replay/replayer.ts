// SPDX-License-Identifier: Apache-2.0
// A journal that a worker replays for its hashes alone: one request after the other.

import { CarvingWorker } from '../local/carving_worker';
import type { FromWorker, ToWorker } from '../local/messages';
import type { GivenJournal } from '../local/program_block';

/** A record, and the hash of the state after it. */
export interface HashAt {
  record: number;
  hash: string;
}

/** The part of CarvingWorker that is used. */
export type ReplayWorker = Pick<CarvingWorker, 'open' | 'post' | 'end'>;
export type MakeReplayWorker = (heard: (message: FromWorker) => void) => ReplayWorker;

/** All functions reject with a sentence that says why. */
export class Replayer {
  private readonly worker_: ReplayWorker;
  private waiting_: { resolve: (at: HashAt) => void; reject: (problem: Error) => void } | null =
    null;
  private progress_: (record: number) => void = () => undefined;

  constructor(make: MakeReplayWorker = (heard) => new CarvingWorker(heard)) {
    this.worker_ = make((message) => this.heard_(message));
  }

  /** Reads a journal, and carves it from its beginning to a record. */
  open(journal: GivenJournal, to: number, progress?: (record: number) => void): Promise<HashAt> {
    return this.asked_(() => {
      this.worker_.open({ type: 'journal', journal, to, isSilent: true });
    }, progress);
  }

  /** Adds records to the journal; they may overlap those that it has. */
  add(spans: readonly Uint8Array<ArrayBuffer>[]): void {
    for (const span of spans) this.worker_.post({ type: 'records', span });
  }

  /** Carves on to a record. */
  carve(to: number, progress?: (record: number) => void): Promise<HashAt> {
    return this.posted_({ type: 'carve', to }, progress);
  }

  /** Goes to a record, back or forth, which makes the history of the journal the first time. */
  seek(motion: number): Promise<HashAt> {
    return this.posted_({ type: 'seek', motion });
  }

  end(): void {
    this.worker_.end();
  }

  private posted_(message: ToWorker, progress?: (record: number) => void): Promise<HashAt> {
    return this.asked_(() => this.worker_.post(message), progress);
  }

  private asked_(ask: () => void, progress?: (record: number) => void): Promise<HashAt> {
    return new Promise((resolve, reject) => {
      this.waiting_ = { resolve, reject };
      this.progress_ = progress ?? ((): void => undefined);
      ask();
    });
  }

  private heard_(message: FromWorker): void {
    if (message.type === 'rejected' || message.type === 'failed')
      this.waiting_?.reject(new Error(message.reason));
    if (message.type !== 'carved') return;
    const { hash, progress } = message;
    if (hash === null) this.progress_(progress.carved);
    else this.waiting_?.resolve({ record: progress.carved, hash });
  }
}
