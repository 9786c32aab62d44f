// SPDX-License-Identifier: Apache-2.0
// Brings the path of the hand to the worker that has the block, as CarveLink brings it to a server.

import type { AgentLink, CarveLinkEvents, CarveStatus } from '../carve/carve_link';
import { Changes } from '../carve/changes';
import type { Draft } from '../carve/sample_log';
import { encodeFrame } from '../wire/encode';
import { BUTTON_CUTTING, FrameType } from '../wire/types';
import type { FromWorker, ToWorker } from './messages';
import { translated } from './reasons';

const SPEED_MM_PER_S = 2000;
const SAMPLES_PER_S = 1000;
const SAMPLES_PER_FRAME = 16; // kMaxSamplesPerMotion of server/wire/limits.h
/** The worker is behind: the hand's next motions wait, and are drawn later. */
const UNANSWERED_MAX = 256;
const REST_MS = 600;

export interface HandLinkOptions {
  post(message: ToWorker): void;
  /** As whom the hand carves. */
  participant(): number;
  /** ms since 1970. */
  wallMs(): number;
  /** Calls once, later, unless it is called again before. */
  later(act: () => void, ms: number): void;
}

export class HandLink implements AgentLink {
  status: CarveStatus = 'off';
  participant: number | null = null;
  /** Samples and requests of the worker pass it on: nothing waits to be sent. */
  get waiting(): number {
    return this.changes_.waiting;
  }
  private sequence_ = 0n;
  private answered_ = 0n;
  private readonly changes_ = new Changes((undone) => this.changeOne_(undone));
  /** Of each stroke that was sent: whether the block has a motion of it. */
  private readonly has_: boolean[] = [];
  /** The strokes of the frames that the worker has not answered, with their newest samples. */
  private frames_: { newest: bigint; stroke: number }[] = [];
  private isCutting_ = false;

  constructor(
    private readonly options: HandLinkOptions,
    private readonly events: CarveLinkEvents,
  ) {}

  get takes(): boolean {
    // A stroke after an undo of several must not be taken for one of them.
    const isFree = this.status === 'ready' && this.changes_.waiting === 0;
    return isFree && this.sequence_ - this.answered_ < UNANSWERED_MAX;
  }

  /** Whether the worker has not answered samples, an undo or a redo yet. */
  get isAsking(): boolean {
    return this.changes_.isBusy || this.answered_ < this.sequence_;
  }

  join(): void {
    if (this.status !== 'off') return;
    const { options } = this;
    this.participant = options.participant();
    this.become_('joining');
    options.post({ type: 'hand', participant: this.participant, wallMs: options.wallMs() });
  }

  leave(): void {
    this.become_('off');
  }

  retryNow(): void {
    // Nothing is lost between a page and its worker.
  }

  send(drafts: readonly Draft[]): void {
    const { options } = this;
    const wallMs = options.wallMs();
    for (const some of this.parts_(drafts)) {
      const samples = some.map((draft) => ({ agent_sequence: ++this.sequence_, ...draft }));
      const spanMs = Math.round(Number(some.at(-1)!.time_us - some[0]!.time_us) / 1000);
      const numbers = { flags: 0, epoch: 1, sequence: this.sequence_, time_us: 0n };
      const frame = encodeFrame({
        header: { type: FrameType.Motion, ...numbers },
        kind: 'motion',
        samples,
      });
      this.frames_.push({ newest: this.sequence_, stroke: this.has_.length - 1 });
      options.post({ type: 'samples', frame, newest: this.sequence_, wallMs, spanMs });
    }
    if (drafts.length > 0) this.restLater_();
  }

  ask(): void {
    // Samples tell the tool, and the page has the block.
  }

  /** Undoes its newest strokes, or redoes those that were undone last: all or none. */
  change(undone: boolean, strokes: number, failed: () => void): void {
    this.changes_.add(undone, strokes, (changed) => {
      if (changed) this.events.changed(undone);
      else failed();
    });
  }

  /** How many strokes the block has of those with these numbers; null: ask again. */
  accepted(from: number, to: number): number | null {
    const isAnswered = this.frames_.every(({ stroke }) => stroke >= to);
    return isAnswered ? this.has_.slice(from, to).filter((has) => has).length : null;
  }

  heard(message: FromWorker): void {
    if (message.type === 'handed' && this.status === 'joining') {
      this.become_('ready');
      const limits = { speedMmPerS: SPEED_MM_PER_S, samplesPerS: SAMPLES_PER_S };
      this.events.joined({ participant: this.participant!, ...limits });
    } else if (message.type === 'felt') {
      this.answered_ = message.newest;
      this.answeredUpTo_(message.newest, message.recorded);
      if (message.reason !== '') this.events.rejected('rejected', translated(message.reason));
      const own = message.progress.tools?.find((one) => one.participant === this.participant);
      this.events.result({
        agent_sequence: message.newest,
        motions_applied: BigInt(message.progress.carved),
        force_n: own?.force_n ?? [0, 0, 0],
      });
    } else if (message.type === 'changed') {
      const { reason } = message;
      if (this.changes_.answered(reason === ''))
        this.events.rejected('bad_message', translated(reason));
    }
  }

  /** The block was replaced, or has ended. */
  drop(): void {
    this.sequence_ = this.answered_ = 0n;
    this.changes_.drop();
    this.has_.fill(false); // of another block
    this.frames_ = [];
    this.isCutting_ = false;
    if (this.status !== 'off') this.become_('off');
  }

  /** Parts of a path for one frame each, none of them with motions of two strokes. */
  private *parts_(drafts: readonly Draft[]): Generator<Draft[]> {
    let part: Draft[] = [];
    for (const draft of drafts) {
      const cuts = (draft.buttons & BUTTON_CUTTING) !== 0;
      const begins = cuts && !this.isCutting_;
      if (part.length === SAMPLES_PER_FRAME || (begins && part.length > 0)) {
        yield part;
        part = [];
      }
      if (begins) this.has_.push(false);
      this.isCutting_ = cuts;
      part.push(draft);
    }
    if (part.length > 0) yield part;
  }

  private answeredUpTo_(newest: bigint, recorded: boolean): void {
    const stroke = this.frames_.find((frame) => frame.newest === newest)?.stroke;
    if (recorded && stroke !== undefined) this.has_[stroke] = true;
    this.frames_ = this.frames_.filter((frame) => frame.newest > newest);
  }

  private changeOne_(undone: boolean): void {
    this.options.post({ type: 'change', undone, wallMs: this.options.wallMs() });
    this.restLater_();
  }

  private become_(status: CarveStatus): void {
    this.status = status;
    this.events.status(status, '');
  }

  private restLater_(): void {
    this.options.later(() => this.options.post({ type: 'rest' }), REST_MS);
  }
}
