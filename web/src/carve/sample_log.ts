// SPDX-License-Identifier: Apache-2.0
// Numbers an agent's samples over all its connections, and keeps those that are not on the server's
// disk yet, so that a server that has lost them gets them again (server/wire/README.md, "Resuming").

import type { Sample } from '../wire/types';

/** A sample without its number. */
export type Draft = Omit<Sample, 'agent_sequence'>;

const KEPT_MAX = 16_384; // a quarter of a minute; beyond that the oldest are given up

export class SampleLog {
  private kept_: Sample[] = [];
  private newest_ = 0n;
  private answered_ = 0n;
  private durable_ = 0n;

  /** Samples that the server has not answered. */
  get unanswered(): number {
    return Number(this.newest_ - this.answered_);
  }

  /** Gives samples their numbers and keeps them. */
  add(drafts: readonly Draft[]): Sample[] {
    const samples = drafts.map((draft) => ({ agent_sequence: ++this.newest_, ...draft }));
    this.kept_.push(...samples);
    if (this.kept_.length > KEPT_MAX) this.kept_.splice(0, this.kept_.length - KEPT_MAX);
    return samples;
  }

  answered(sequence: bigint): void {
    if (sequence > this.answered_) this.answered_ = sequence;
  }

  /** The samples up to this one are on disk. The last of them stays: others may follow it. */
  durable(sequence: bigint): void {
    if (sequence <= this.durable_) return;
    this.durable_ = sequence;
    const first = this.kept_.findIndex((sample) => sample.agent_sequence >= sequence);
    if (first > 0) this.kept_.splice(0, first);
  }

  /**
   * The samples that a new connection sends first: the newest one that the server has, which places
   * the tool, and those after it. A page that was loaded again has none, and numbers on from there.
   */
  toResend(serverHas: bigint): Sample[] {
    if (serverHas > this.newest_) this.newest_ = serverHas;
    this.answered(serverHas);
    return this.kept_.filter((sample) => sample.agent_sequence >= serverHas);
  }
}
