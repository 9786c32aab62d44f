// SPDX-License-Identifier: Apache-2.0
// The worker's side of a page that carves by itself: carves in slices, between which it hears the
// page, and meshes for a part of the time only.

import type { FromWorker, ToWorker } from './messages';
import type { About, ProgramBlock } from './program_block';

const SLICE_MS = 30;
/** Least time between two meshes, in ms and relative to the duration of the last one. */
const MESH_EVERY_MS = 150;
const MESH_SHARE = 3;
/** The same for a block that is played. */
const PLAY_EVERY_MS = 16;
const PLAY_SHARE = 1;
/** Of a block that is played, ms; and pauses that are passed over, s of its clock. */
const HASH_EVERY_MS = 1000;
const PAUSE_S = 1;
const PLAY_TOGETHER = 64;

/** The surroundings of the carver. */
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
  private isSilent_ = false;
  /** While it plays: how fast, and where its clock was at what time of the page's. */
  private playing_: { rate: number; fromS: number; fromMs: number } | null = null;
  /** With which it plays once it is where it was sent. */
  private rateThen_ = 0;
  private hashedMs_ = 0;
  /** A hand takes the block over, when it is at its last record. */
  private isHanding_ = false;
  /** A hand carves: it waits for the picture, and no one for the hash. */
  private isHot_ = false;

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
        this.open_(block, () => block.read(message.files));
        return;
      case 'journal':
        this.open_(block, () => block.readJournal(message.journal), message);
        return;
      case 'records':
        this.extend_(block, message.span);
        return;
      case 'carve':
        this.goOn_(message.to);
        return;
      case 'seek':
        this.seek_(block, message.motion);
        return;
      case 'play':
        this.play_(block, message.rate);
        return;
      case 'digests':
        if (this.about_) this.around.post({ type: 'digests', tiles: block.digests() });
        return;
      case 'mesh':
        if (this.about_) this.around.post({ type: 'mesh', tile: block.mesh(message.x, message.y) });
        return;
      case 'stop':
        this.playing_ = null;
        this.rateThen_ = 0;
        if (this.about_) this.target_ = Math.min(this.target_, block.progress().carved);
        return;
      case 'model':
        this.write_(block, message);
        return;
      case 'hand':
        this.beginHand_(block, message);
        return;
      case 'samples':
        this.cutByHand_(block, message);
        return;
      case 'change':
        this.changeByHand_(block, message);
        return;
      case 'tool':
        this.makeTool_(block, message);
        return;
      case 'rest':
        this.isHot_ = false;
        this.changed_();
        return;
      case 'save':
        if (this.about_) this.around.post({ type: 'saved', parts: block.parts() });
    }
  }

  private open_(
    block: ProgramBlock,
    read: () => void,
    { to = Infinity, isSilent = false }: { to?: number; isSilent?: boolean } = {},
  ): void {
    this.about_ = null;
    this.playing_ = null;
    this.rateThen_ = 0;
    this.isHanding_ = false;
    this.isHot_ = false;
    const isRead = this.try_(() => {
      read();
      block.make();
    });
    if (!isRead) return;
    this.about_ = block.about();
    this.isSilent_ = isSilent;
    this.around.post({ type: 'opened', about: this.about_, path: block.path() });
    this.target_ = Math.min(to, this.about_.motions);
    this.carvingMs_ = 0;
    this.meshedMs_ = -Infinity;
    this.meshTookMs_ = 0;
    this.changed_();
  }

  private extend_(block: ProgramBlock, span: Uint8Array): void {
    if (!this.about_) return;
    this.try_(() => block.addRecords(span));
    this.about_ = block.about();
  }

  private goOn_(to: number): void {
    if (!this.about_) return;
    this.playing_ = null;
    this.rateThen_ = 0;
    this.target_ = Math.min(this.about_.motions, to);
    this.changed_();
  }

  private seek_(block: ProgramBlock, motion: number): void {
    if (!this.about_) return;
    this.playing_ = null;
    this.rateThen_ = 0;
    const to = Math.max(0, Math.min(this.about_.motions, motion));
    if (this.try_(() => block.seek(to))) this.target_ = to;
    this.changed_();
  }

  private play_(block: ProgramBlock, rate: number): void {
    if (!this.about_) return;
    if (block.progress().carved < this.target_ && !this.playing_) this.rateThen_ = rate;
    else this.playFrom_(block, rate);
    this.changed_();
  }

  // The hand
  // -----------------------------------------------------------------------------------------------

  private beginHand_(
    block: ProgramBlock,
    { participant, wallMs }: ToWorker & { type: 'hand' },
  ): void {
    if (!this.about_) return;
    this.playing_ = null;
    this.rateThen_ = 0;
    const isProgram = this.about_.kernel_version === undefined;
    const isTaken = this.try_(() => {
      block.hand(participant, wallMs);
      if (isProgram) block.make();
      else block.seek(this.about_!.motions);
    });
    if (!isTaken) return;
    this.about_ = block.about();
    this.target_ = this.about_.motions;
    this.isHanding_ = true;
    this.changed_();
  }

  private cutByHand_(
    block: ProgramBlock,
    { frame, newest, wallMs, spanMs }: ToWorker & { type: 'samples' },
  ): void {
    const { carved } = block.progress();
    const reason = this.reasonOf_(() => block.samples(frame, wallMs, spanMs));
    const progress = block.progress();
    const recorded = progress.carved > carved;
    this.around.post({ type: 'felt', newest, progress, recorded, reason });
    this.handMoved_(block);
  }

  private makeTool_(block: ProgramBlock, { tool, wallMs }: ToWorker & { type: 'tool' }): void {
    let id = 0;
    const reason = this.reasonOf_(() => (id = block.tool(tool, wallMs)));
    this.around.post({ type: 'tool', id, tools: block.about().tools, reason });
    this.handMoved_(block);
  }

  private changeByHand_(
    block: ProgramBlock,
    { undone, wallMs }: ToWorker & { type: 'change' },
  ): void {
    const reason = this.reasonOf_(() => block.change(undone, wallMs));
    this.around.post({ type: 'changed', undone, reason });
    this.handMoved_(block);
  }

  private handMoved_(block: ProgramBlock): void {
    this.isHot_ = true;
    this.about_ = block.about();
    this.target_ = this.about_.motions;
    this.changed_();
  }

  /** Why the block rejects a change; empty if it accepts it. */
  private reasonOf_(act: () => void): string {
    try {
      act();
      return '';
    } catch (problem) {
      if (problem instanceof WebAssembly.RuntimeError) throw problem;
      return (problem as Error).message;
    }
  }

  // Slices
  // -----------------------------------------------------------------------------------------------

  private playFrom_(block: ProgramBlock, rate: number): void {
    const { carved, time_s } = block.progress();
    this.target_ = carved;
    this.playing_ = rate > 0 ? { rate, fromS: time_s, fromMs: this.around.nowMs() } : null;
    this.rateThen_ = 0;
    this.hashedMs_ = -Infinity;
  }

  /** Reports the block's errors to the page. */
  private try_(act: () => void): boolean {
    const reason = this.reasonOf_(act);
    if (reason !== '') this.around.post({ type: 'rejected', reason });
    return reason === '';
  }

  private write_(block: ProgramBlock, { format }: ToWorker & { type: 'model' }): void {
    if (!this.about_) return;
    const reason = this.reasonOf_(() =>
      this.around.post({ type: 'model', format, bytes: block.model(format) }),
    );
    if (reason !== '') this.around.post({ type: 'unwritten', reason });
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
    const beganMs = this.around.nowMs();
    const { playing_: playing } = this;
    const done = this.try_(() => {
      if (playing) this.playOn_(block, playing);
      else this.carveOn_(block);
    });
    const { carved, next_s } = block.progress();
    if (!done || (playing && next_s === null)) this.playing_ = null;
    if (!done || playing) this.target_ = carved;
    if (!done) this.rateThen_ = 0;
    if (this.rateThen_ > 0 && carved >= this.target_) this.playFrom_(block, this.rateThen_);
    this.carvingMs_ += this.around.nowMs() - beganMs;
    const atRest = !this.playing_ && carved >= this.target_;
    if (!done) this.isHanding_ = false;
    if (this.isHanding_) this.hand_(block, atRest);
    else this.show_(block, atRest);
  }

  /** The displayed tiles stay until the block is there again. */
  private hand_(block: ProgramBlock, atRest: boolean): void {
    if (atRest) {
      this.isHanding_ = false;
      this.around.post({ type: 'handed', about: block.about() });
    }
    this.changed_();
  }

  private carveOn_(block: ProgramBlock): void {
    const { around } = this;
    const beganMs = around.nowMs();
    let { carved } = block.progress();
    while (carved < this.target_ && around.nowMs() - beganMs < SLICE_MS) {
      const partMs = around.nowMs();
      const motions = Math.min(this.together_, this.target_ - carved);
      block.carve(motions);
      carved += motions;
      const tookMs = around.nowMs() - partMs;
      if (tookMs > SLICE_MS / 4) this.together_ = Math.max(1, this.together_ >> 1);
      else if (tookMs < SLICE_MS / 16) this.together_ *= 2;
    }
  }

  /** Carves the motions that are due. If carving is too slow, the clock waits for it. */
  private playOn_(
    block: ProgramBlock,
    playing: { rate: number; fromS: number; fromMs: number },
  ): void {
    const { around } = this;
    const beganMs = around.nowMs();
    const untilS = playing.fromS + (playing.rate * (beganMs - playing.fromMs)) / 1000;
    let { next_s: next, time_s: at } = block.progress();
    if (next !== null && next > untilS + PAUSE_S && next > at + PAUSE_S) {
      playing.fromS = next;
      playing.fromMs = beganMs;
    }
    while (next !== null && next <= untilS && around.nowMs() - beganMs < SLICE_MS) {
      block.play(untilS, PLAY_TOGETHER);
      ({ next_s: next, time_s: at } = block.progress());
    }
    if (next === null || next > untilS) return;
    playing.fromS = at;
    playing.fromMs = around.nowMs();
  }

  /** Meshes the changed tiles, if it is time to. */
  private show_(block: ProgramBlock, atRest: boolean): void {
    const { around } = this;
    const beganMs = around.nowMs();
    const [everyMs, share] = this.playing_
      ? [PLAY_EVERY_MS, PLAY_SHARE]
      : [MESH_EVERY_MS, MESH_SHARE];
    const pauseMs = Math.max(everyMs, share * this.meshTookMs_);
    if (atRest || beganMs - this.meshedMs_ >= pauseMs) {
      const tiles = this.isSilent_ ? [] : block.changed();
      this.meshedMs_ = around.nowMs();
      this.meshTookMs_ = this.meshedMs_ - beganMs;
      this.isShown_ = atRest;
      around.post({
        type: 'carved',
        progress: block.progress(),
        tiles,
        hash: this.hashOf_(block, atRest),
        rate: this.playing_?.rate ?? 0,
        carvingMs: this.carvingMs_,
      });
    }
    if (!this.isShown_) this.changed_();
  }

  private hashOf_(block: ProgramBlock, atRest: boolean): string | null {
    if (this.isHot_) return null;
    const nowMs = this.around.nowMs();
    if (!atRest && !(this.playing_ && nowMs - this.hashedMs_ >= HASH_EVERY_MS)) return null;
    this.hashedMs_ = nowMs;
    return block.hash();
  }

  private failed_(problem: unknown): void {
    this.block_ = null;
    this.around.post({ type: 'failed', reason: (problem as Error).message });
  }
}
