// SPDX-License-Identifier: Apache-2.0
// The page's connection as an agent of the session: joins, sends samples, delivers results, and
// after a loss continues as the same participant, without a gap in its path, also at another server.

import { t } from '../strings';
import type { BlockCopy } from '../kernel/block_copy';
import { Backoff } from '../link/backoff';
import { Servers } from '../link/servers';
import { Silence } from '../link/silence';
import type { Socket } from '../link/socket';
import type { Stroke } from '../model/stroke';
import { parseAgentControl } from '../wire/agent_control';
import type { AgentHello, AgentMessage, AgentRequest, AgentWelcome } from '../wire/agent_control';
import { decodeFrame } from '../wire/decode';
import { encodeFrame } from '../wire/encode';
import {
  AGENT_PROTOCOL,
  BUTTON_CUTTING,
  FrameType,
  STATUS_REJECTED,
  STOCK_RESET,
  STOCK_RETURNED,
} from '../wire/types';
import type { Header, Payload, Result, Sample } from '../wire/types';
import { Changes } from './changes';
import { Pace } from './pace';
import { SampleLog } from './sample_log';
import type { Draft } from './sample_log';
import { StrokeCensus } from './stroke_census';

export type CarveStatus = 'off' | 'joining' | 'ready' | 'lost';

export interface CarveLinkEvents {
  /** The status changed; `reason` is for the user, empty if all is well. */
  status(status: CarveStatus, reason: string): void;
  joined(welcome: Pick<AgentWelcome, 'participant' | 'speedMmPerS' | 'samplesPerS'>): void;
  result(result: Pick<Result, 'force_n' | 'agent_sequence' | 'motions_applied'>): void;
  /** A motion was rejected, or a stroke was not undone. */
  rejected(code: string, reason: string): void;
  /** Own strokes were undone (true) or redone. */
  changed(undone: boolean): void;
}

/**
 * Delivers the path of the hand to the block: by a connection, or in the page that has the block.
 */
export type AgentLink = Pick<
  CarveLink,
  | 'status'
  | 'participant'
  | 'takes'
  | 'waiting'
  | 'isAsking'
  | 'join'
  | 'leave'
  | 'retryNow'
  | 'send'
  | 'ask'
  | 'change'
  | 'accepted'
>;

export interface CarveLinkOptions {
  /** At the server that the page comes from; that one may send it on to another. */
  url: string;
  open(url: string, protocol: string): Socket;
  /** Who joins: name and color of the watcher, and the tool. */
  who(): Pick<AgentHello, 'name' | 'color' | 'tool'>;
  nowMs(): number;
  /** The page's copy of the block, which sees all messages of this link. */
  copy: Pick<BlockCopy, 'works' | 'open' | 'tools' | 'cut' | 'take' | 'change' | 'settle'>;
  /** Of the page before this one, which was loaded again; empty: none. */
  token?: string;
  /** The token with which the next page continues. */
  keep?: (token: string) => void;
  /** The session's strokes that begin at a record or later. */
  list: (since: number) => Promise<readonly Stroke[]>;
  backoff?: Backoff;
}

const PING_EVERY_MS = 1000; // pongs state the durable sequence, also while the tool rests
const UNANSWERED_MAX = 512; // half a second at full rate: a slow server is not flooded
const AGAIN_EVERY_MS = 20;

export class CarveLink {
  private socket_: Socket | null = null;
  private generation_ = 0; // counts connections; events of earlier ones are ignored
  private status_: CarveStatus = 'off';
  private welcome_: AgentWelcome | null = null;
  private token_ = '';
  private sequence_ = 0n;
  private readonly silence_ = new Silence(PING_EVERY_MS);
  private readonly servers_: Servers;
  private bye_ = { reason: '', redirect: '' };
  /**
   * The copy forgets its own motions after four seconds (haptic_agent/replica), so that it cuts no
   * more after a loss until it has the server's stock again.
   */
  private awaitsStock_ = false;
  private timer_: ReturnType<typeof setInterval> | undefined;
  private retry_: ReturnType<typeof setTimeout> | undefined;
  private readonly log_ = new SampleLog();
  private again_: Sample[] = []; // to be sent again before new ones
  private againTimer_: ReturnType<typeof setTimeout> | undefined;
  /** The server makes one at a time. */
  private readonly changes_ = new Changes((undone) => this.changeOne_(undone));
  private readonly census_: StrokeCensus;
  private readonly backoff_: Backoff;

  constructor(
    private readonly options: CarveLinkOptions,
    private readonly events: CarveLinkEvents,
  ) {
    this.backoff_ = options.backoff ?? new Backoff();
    this.servers_ = new Servers(options.url);
    this.token_ = options.token ?? '';
    this.census_ = new StrokeCensus(async (since) =>
      (await options.list(since)).filter(({ participant: one }) => one === this.participant),
    );
  }

  get status(): CarveStatus {
    return this.status_;
  }

  /** Of the last welcome; null before it. */
  get participant(): number | null {
    return this.welcome_?.participant ?? null;
  }

  /** Whether samples may be sent now. */
  get takes(): boolean {
    const isReady = this.status_ === 'ready' && !this.awaitsStock_ && this.waiting === 0;
    return isReady && this.log_.unanswered < UNANSWERED_MAX && !this.census_.isUnclear;
  }

  /** How many samples wait to be sent again, and requests to be sent. */
  get waiting(): number {
    return this.again_.length + this.changes_.waiting;
  }

  /** Whether the server has not answered an undo or redo yet. */
  get isAsking(): boolean {
    return this.changes_.isBusy;
  }

  /** Joins, as the participant of before if there was one. */
  join(): void {
    if (this.status_ === 'off') this.connect_('');
  }

  /** Leaves the session. */
  leave(): void {
    clearTimeout(this.retry_);
    this.drop_();
    this.become_('off', '');
  }

  /** Tries now instead of after the delay. */
  retryNow(): void {
    if (this.status_ !== 'lost') return;
    clearTimeout(this.retry_);
    this.connect_('');
  }

  send(drafts: readonly Draft[]): void {
    const samples = this.log_.add(drafts);
    for (const { agent_sequence, buttons } of samples)
      this.census_.sent(agent_sequence, (buttons & BUTTON_CUTTING) !== 0);
    this.sendSamples_(samples, true);
  }

  ask(request: AgentRequest): void {
    if (this.status_ === 'ready') this.socket_?.send(JSON.stringify(request));
  }

  /** Undoes its newest strokes, or redoes those undone last: all or none. They change here at once. */
  change(undone: boolean, strokes: number, failed: () => void): void {
    if (this.status_ !== 'ready') {
      failed();
      return;
    }
    for (let n = 0; n < strokes; n += 1) this.options.copy.change(undone);
    this.changes_.add(undone, strokes, (changed) => {
      if (changed) this.events.changed(undone);
      else failed();
    });
  }

  /** How many strokes the server has of those with these numbers; null: ask again. */
  accepted(from: number, to: number): number | null {
    return this.census_.accepted(from, to);
  }

  private changeOne_(undone: boolean): void {
    this.socket_?.send(JSON.stringify({ type: undone ? 'undo' : 'redo' }));
  }

  private connect_(reason: string): void {
    const generation = ++this.generation_;
    this.become_('joining', reason);
    this.bye_ = { reason: '', redirect: '' };
    this.silence_.begin(this.options.nowMs());
    const socket = this.options.open(this.servers_.url, AGENT_PROTOCOL);
    socket.binaryType = 'arraybuffer';
    this.socket_ = socket;
    const isCurrent = (): boolean => generation === this.generation_;
    socket.onopen = () => {
      if (isCurrent()) socket.send(JSON.stringify(this.hello_()));
    };
    socket.onmessage = ({ data }) => {
      if (isCurrent()) this.received_(data);
    };
    socket.onclose = ({ reason: why }) => {
      if (isCurrent()) this.lost_(this.bye_.reason || why || t('The connection was lost.'));
    };
    socket.onerror = () => {
      // A close event always follows.
    };
    clearInterval(this.timer_);
    this.timer_ = setInterval(() => this.tick_(), PING_EVERY_MS);
  }

  private hello_(): AgentHello {
    const token = this.token_ === '' ? {} : { resume: this.token_ };
    const wish = { stock: true, whole: true, returned: true } as const;
    const stock = this.options.copy.works ? wish : {};
    return { type: 'hello', ...this.options.who(), durable: true, ...stock, ...token };
  }

  private drop_(): void {
    this.generation_ += 1;
    clearInterval(this.timer_);
    clearTimeout(this.againTimer_);
    this.again_ = [];
    this.changes_.drop();
    this.socket_?.close();
    this.socket_ = null;
  }

  private become_(status: CarveStatus, reason: string): void {
    this.status_ = status;
    this.events.status(status, reason);
  }

  private lost_(reason: string): void {
    const isNamed = this.servers_.lost(this.bye_.redirect, this.status_ === 'ready');
    this.drop_();
    if (isNamed) {
      this.connect_('');
      return;
    }
    this.become_('lost', reason);
    this.retry_ = setTimeout(() => this.connect_(reason), this.backoff_.next());
  }

  private tick_(): void {
    if (this.silence_.tick(this.options.nowMs())) {
      this.lost_(t('The server stopped answering.'));
      return;
    }
    if (this.status_ === 'ready')
      this.sendFrame_(FrameType.Ping, { kind: 'ping', time_us: this.nowUs_() });
  }

  private nowUs_(): bigint {
    return BigInt(Math.round(this.options.nowMs() * 1000));
  }

  private sendFrame_(type: FrameType, payload: Payload, sequence?: bigint): Uint8Array | null {
    if (!this.socket_ || !this.welcome_) return null;
    this.sequence_ += 1n;
    const { epoch } = this.welcome_;
    const numbers = { sequence: sequence ?? this.sequence_, time_us: this.nowUs_() };
    const frame = encodeFrame({ header: { type, flags: 0, epoch, ...numbers }, ...payload });
    this.socket_.send(frame);
    return frame;
  }

  /** `isNew`: to the copy too, which cuts them. */
  private sendSamples_(all: Sample[], isNew: boolean): void {
    const most = this.welcome_?.samplesPerMessage ?? 1;
    for (let at = 0; at < all.length; at += most) {
      const samples = all.slice(at, at + most);
      const frame = this.sendFrame_(FrameType.Motion, { kind: 'motion', samples });
      if (frame && isNew) this.options.copy.cut(frame, samples.at(-1)!.agent_sequence);
    }
  }

  private sendAgain_(pace: Pace, isNew: boolean): void {
    const count = pace.take(this.again_.length, this.options.nowMs());
    this.sendSamples_(this.again_.splice(0, count), isNew);
    if (this.again_.length === 0) return;
    this.againTimer_ = setTimeout(() => this.sendAgain_(pace, isNew), AGAIN_EVERY_MS);
  }

  private received_(data: unknown): void {
    this.silence_.heard(this.options.nowMs());
    if (typeof data === 'string') {
      const message = parseAgentControl(data);
      if (message.ok && message.value) this.heard_(message.value, data);
    } else if (data instanceof ArrayBuffer) {
      this.receivedFrame_(data);
    }
  }

  private receivedFrame_(bytes: ArrayBuffer): void {
    const frame = decodeFrame(bytes);
    if (!frame.ok) return;
    const { header } = frame.value;
    if (header.durable_sequence !== undefined) this.log_.durable(header.durable_sequence);
    if (frame.value.kind === 'stock') this.receivedStock_(header, bytes);
    if (frame.value.kind !== 'result') return;
    this.options.copy.take(new Uint8Array(bytes));
    const { agent_sequence, status } = frame.value.result;
    if (status & STATUS_REJECTED) this.census_.doubt();
    this.log_.answered(agent_sequence);
    this.census_.answered(agent_sequence);
    this.events.result(frame.value.result);
  }

  private receivedStock_({ sequence, flags }: Header, bytes: ArrayBuffer): void {
    this.options.copy.take(new Uint8Array(bytes));
    this.sendFrame_(FrameType.Ack, { kind: 'ack' }, sequence);
    if (flags & STOCK_RESET) this.awaitsStock_ = false;
    // An undo of anybody divides the stroke.
    if (flags & STOCK_RETURNED && this.census_.isCutting) this.census_.doubt();
  }

  private heard_(message: AgentMessage, text: string): void {
    switch (message.type) {
      case 'welcome': {
        this.joined_(message, text);
        return;
      }
      case 'tools':
        this.options.copy.tools(text);
        return;
      case 'stroke':
        this.answered_(message);
        return;
      case 'bye':
        this.bye_ = message;
        return;
      case 'servers':
        this.servers_.welcomed(message.others);
        return;
      case 'error': {
        this.failed_(message.code, message.reason, message.fatal);
        return;
      }
    }
  }

  private answered_({ code, reason }: Extract<AgentMessage, { type: 'stroke' }>): void {
    const isFailure = this.changes_.answered(code === undefined);
    if (code !== undefined) this.options.copy.settle();
    if (isFailure) this.events.rejected(code!, reason ?? '');
  }

  private joined_(welcome: AgentWelcome, text: string): void {
    const { token, resumed, agentSequence } = welcome.resume;
    const hasCopy = this.welcome_ !== null && resumed;
    if (hasCopy) this.census_.doubt();
    else if (resumed) void this.census_.begin();
    else this.census_.forget();
    this.welcome_ = welcome;
    this.token_ = token;
    this.options.keep?.(token);
    this.servers_.welcomed(welcome.others);
    if (!hasCopy) this.options.copy.open(text);
    this.again_ = this.log_.toResend(agentSequence);
    this.awaitsStock_ = resumed && this.options.copy.works && this.again_.length > 0;
    this.sendAgain_(new Pace(welcome.samplesPerS, this.options.nowMs()), !resumed);
    this.backoff_.reset();
    this.become_('ready', '');
    this.events.joined(welcome);
  }

  private failed_(code: string, reason: string, fatal: boolean): void {
    if (!fatal) {
      this.census_.doubt();
      this.events.rejected(code, reason);
      return;
    }
    // Do not reconnect after removal or loss of rights.
    const isFinal = code === 'removed' || code === 'not_allowed' || code === 'unknown_session';
    if (!isFinal) {
      this.lost_(reason);
      return;
    }
    this.drop_();
    this.become_('off', reason);
  }
}
