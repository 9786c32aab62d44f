// SPDX-License-Identifier: Apache-2.0
// Brings the path of the hand to the worker that has the block, as CarveLink brings it to a server.

import type { AgentLink, CarveLinkEvents, CarveStatus } from '../carve/carve_link';
import type { Draft } from '../carve/sample_log';
import type { AgentRequest } from '../wire/agent_control';
import { encodeFrame } from '../wire/encode';
import { FrameType } from '../wire/types';
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
  readonly waiting = 0;
  private sequence_ = 0n;
  private answered_ = 0n;
  private asked_ = 0;

  constructor(
    private readonly options: HandLinkOptions,
    private readonly events: CarveLinkEvents,
  ) {}

  get takes(): boolean {
    return this.status === 'ready' && this.sequence_ - this.answered_ < UNANSWERED_MAX;
  }

  /** Whether the worker has not answered samples, an undo or a redo yet. */
  get isAsking(): boolean {
    return this.asked_ > 0 || this.answered_ < this.sequence_;
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
    for (let at = 0; at < drafts.length; at += SAMPLES_PER_FRAME) {
      const some = drafts.slice(at, at + SAMPLES_PER_FRAME);
      const samples = some.map((draft) => ({ agent_sequence: ++this.sequence_, ...draft }));
      const spanMs = Math.round(Number(some.at(-1)!.time_us - some[0]!.time_us) / 1000);
      const numbers = { flags: 0, epoch: 1, sequence: this.sequence_, time_us: 0n };
      const frame = encodeFrame({
        header: { type: FrameType.Motion, ...numbers },
        kind: 'motion',
        samples,
      });
      options.post({ type: 'samples', frame, newest: this.sequence_, wallMs, spanMs });
    }
    if (drafts.length > 0) this.restLater_();
  }

  ask({ type }: AgentRequest): void {
    if (type !== 'undo' && type !== 'redo') return;
    const { options } = this;
    this.asked_ += 1;
    options.post({ type: 'change', undone: type === 'undo', wallMs: options.wallMs() });
    this.restLater_();
  }

  heard(message: FromWorker): void {
    if (message.type === 'handed' && this.status === 'joining') {
      this.become_('ready');
      const limits = { speedMmPerS: SPEED_MM_PER_S, samplesPerS: SAMPLES_PER_S };
      this.events.joined({ participant: this.participant!, ...limits });
    } else if (message.type === 'felt') {
      this.answered_ = message.newest;
      if (message.reason !== '') this.events.rejected('rejected', translated(message.reason));
      const own = message.progress.tools?.find((one) => one.participant === this.participant);
      this.events.result({
        agent_sequence: message.newest,
        motions_applied: BigInt(message.progress.carved),
        force_n: own?.force_n ?? [0, 0, 0],
      });
    } else if (message.type === 'changed') {
      this.asked_ -= 1;
      if (message.reason === '') this.events.changed(message.undone);
      else this.events.rejected('bad_message', translated(message.reason));
    }
  }

  /** The block was replaced, or has ended. */
  drop(): void {
    this.sequence_ = this.answered_ = 0n;
    this.asked_ = 0;
    if (this.status !== 'off') this.become_('off');
  }

  private become_(status: CarveStatus): void {
    this.status = status;
    this.events.status(status, '');
  }

  private restLater_(): void {
    this.options.later(() => this.options.post({ type: 'rest' }), REST_MS);
  }
}
