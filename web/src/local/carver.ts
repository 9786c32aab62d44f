// SPDX-License-Identifier: Apache-2.0
// The worker's side of the page without a server: carves in slices, between which it hears the page,
// and meshes for a part of the time only.

import type { FromWorker, ToWorker } from './messages';
import type { About, ProgramBlock } from './program_block';

const SLICE_MS = 30;
/** Between two meshes, and in times of what the last one took. */
const MESH_EVERY_MS = 150;
const MESH_SHARE = 3;

/** What the carver needs of its surroundings. */
export interface Surroundings {
  post(message: FromWorker): void;
  load(module: WebAssembly.Module): Promise<ProgramBlock>;
  /** Calls when messages that wait have been heard. */
  later(act: () => void): void;
  nowMs(): number;
}

export class Carver {
  private block_: ProgramBlock | null = null;
  private about_: About | null = null;
  private target_ = 0;
  private isDue_ = false;
  private isShown_ = false; // nothing has changed since the last meshes
  private together_ = 1; // motions of a slice's part
  private carvingMs_ = 0;
  private meshedMs_ = 0;
  private meshTookMs_ = 0;

  constructor(private readonly around: Surroundings) {}

  async receive(message: ToWorker): Promise<void> {
    try {
      if (message.type === 'load') this.block_ = await this.around.load(message.module);
      else if (this.block_) this.heard_(this.block_, message);
    } catch (problem) {
      this.failed_(problem);
    }
  }

  private heard_(block: ProgramBlock, message: Exclude<ToWorker, { type: 'load' }>): void {
    switch (message.type) {
      case 'open':
        this.open_(block, message);
        return;
      case 'seek':
        if (!this.about_) return;
        this.target_ = Math.max(0, Math.min(this.about_.motions, message.motion));
        block.seek(this.target_);
        this.changed_();
        return;
      case 'stop':
        if (this.about_) this.target_ = Math.min(this.target_, block.progress().carved);
        return;
      case 'model':
        this.write_(block, message);
    }
  }

  private open_(block: ProgramBlock, { files }: ToWorker & { type: 'open' }): void {
    this.about_ = null;
    try {
      block.read(files);
      block.make();
    } catch (problem) {
      if (!(problem instanceof WebAssembly.RuntimeError))
        this.around.post({ type: 'rejected', reason: (problem as Error).message });
      else throw problem;
      return;
    }
    this.about_ = block.about();
    this.around.post({ type: 'opened', about: this.about_, path: block.path() });
    this.target_ = this.about_.motions;
    this.carvingMs_ = 0;
    this.meshedMs_ = -Infinity;
    this.meshTookMs_ = 0;
    this.changed_();
  }

  private write_(block: ProgramBlock, { format }: ToWorker & { type: 'model' }): void {
    if (!this.about_) return;
    try {
      this.around.post({ type: 'model', format, bytes: block.model(format) });
    } catch (problem) {
      if (problem instanceof WebAssembly.RuntimeError) throw problem;
      this.around.post({ type: 'unwritten', reason: (problem as Error).message });
    }
  }

  private changed_(): void {
    this.isShown_ = false;
    if (this.isDue_) return;
    this.isDue_ = true;
    this.around.later(() => {
      this.isDue_ = false;
      try {
        if (this.block_ && this.about_) this.slice_(this.block_);
      } catch (problem) {
        this.failed_(problem);
      }
    });
  }

  private slice_(block: ProgramBlock): void {
    const { around } = this;
    const beganMs = around.nowMs();
    let { carved } = block.progress();
    try {
      while (carved < this.target_ && around.nowMs() - beganMs < SLICE_MS) {
        const partMs = around.nowMs();
        const motions = Math.min(this.together_, this.target_ - carved);
        block.carve(motions);
        carved += motions;
        const tookMs = around.nowMs() - partMs;
        if (tookMs > SLICE_MS / 4) this.together_ = Math.max(1, this.together_ >> 1);
        else if (tookMs < SLICE_MS / 16) this.together_ *= 2;
      }
    } catch (problem) {
      if (problem instanceof WebAssembly.RuntimeError) throw problem;
      this.target_ = block.progress().carved;
      around.post({ type: 'rejected', reason: (problem as Error).message });
    }
    this.carvingMs_ += around.nowMs() - beganMs;
    this.show_(block, carved >= this.target_);
  }

  /** Meshes what has changed, if it is time to. */
  private show_(block: ProgramBlock, atRest: boolean): void {
    const { around } = this;
    const beganMs = around.nowMs();
    const pauseMs = Math.max(MESH_EVERY_MS, MESH_SHARE * this.meshTookMs_);
    if (atRest || beganMs - this.meshedMs_ >= pauseMs) {
      const tiles = block.changed();
      this.meshedMs_ = around.nowMs();
      this.meshTookMs_ = this.meshedMs_ - beganMs;
      this.isShown_ = atRest;
      around.post({
        type: 'carved',
        progress: block.progress(),
        tiles,
        hash: atRest ? block.hash() : null,
        carvingMs: this.carvingMs_,
      });
    }
    if (!this.isShown_) this.changed_();
  }

  private failed_(problem: unknown): void {
    this.block_ = null;
    this.around.post({ type: 'failed', reason: (problem as Error).message });
  }
}
