// SPDX-License-Identifier: Apache-2.0
// The viewer's connection to one session: says hello, hands out typed events, acknowledges mesh frames after they were applied
// (the acknowledgement is the credit for the next one), measures the round trip, and comes back by itself when the line breaks.

import { decodeFrame, encodeFrame } from '../wire/codec';
import { parseControl } from '../wire/control';
import { FrameType, VIEW_PROTOCOL } from '../wire/types';
import type { Frame, Header, Look, ServerMessage, ToolState } from '../wire/types';
import { Backoff } from './backoff';

export type LinkStatus = 'connecting' | 'connected' | 'reconnecting' | 'stopped';

export interface LinkEvents {
  /** The status changed; `reason` is a sentence for a person, empty if all is well. */
  status(status: LinkStatus, reason: string): void;
  message(message: ServerMessage): void;
  tools(header: Header, tools: ToolState[]): void;
  /** Applies a mesh frame. Frames come one at a time, in order; the next one waits for the promise. */
  mesh(header: Header, glb: Uint8Array): Promise<void>;
  pong(sentMs: number, receivedMs: number, serverUs: bigint): void;
  /** The server sent something that makes no sense, or a frame could not be applied. The link goes on. */
  problem(reason: string): void;
}

/** The part of WebSocket that is used, so that a test can bring its own. */
export interface Socket {
  binaryType: string;
  onopen: ((event: never) => void) | null;
  onmessage: ((event: { data: unknown }) => void) | null;
  onclose: ((event: { code: number; reason: string }) => void) | null;
  onerror: ((event: never) => void) | null;
  send(data: string | Uint8Array<ArrayBuffer>): void;
  close(code?: number, reason?: string): void;
}

export interface LinkOptions {
  url: string;
  name: string;
  open(url: string, protocol: string): Socket;
  /** Asks over HTTP why a connection cannot be made; a text means: give up, and tell the user this. */
  probe(): Promise<string | null>;
  nowMs(): number;
  backoff?: Backoff;
}

const PING_EVERY_MS = 2000;
const SILENCE_MAX_MS = 10000;

export class ViewLink {
  private socket_: Socket | null = null;
  private generation_ = 0; // of the connection: late events of an old one are ignored
  private applying_: Promise<void> = Promise.resolve();
  private epoch_ = 0;
  private sequence_ = 0n;
  private heardMs_ = 0;
  private tickMs_ = 0;
  private byeReason_ = '';
  private welcomed_ = false;
  private stopped_ = false;
  private pingTimer_: ReturnType<typeof setInterval> | undefined;
  private retryTimer_: ReturnType<typeof setTimeout> | undefined;
  private readonly backoff_: Backoff;

  constructor(private readonly options: LinkOptions, private readonly events: LinkEvents) {
    this.backoff_ = options.backoff ?? new Backoff();
  }

  start(): void {
    this.stopped_ = false;
    this.connect_('connecting', '');
  }

  /** Closes for good. */
  stop(reason = ''): void {
    this.stopped_ = true;
    this.drop_();
    clearTimeout(this.retryTimer_);
    this.events.status('stopped', reason);
  }

  /** Does not wait for the next attempt, e.g. when the device came back online. */
  retryNow(): void {
    if (this.stopped_ || this.socket_) return;
    clearTimeout(this.retryTimer_);
    this.connect_('reconnecting', '');
  }

  /** Tells the server how exact the block must be; nothing while there is no session. */
  look(look: Look): void {
    if (this.welcomed_) this.socket_?.send(JSON.stringify({ type: 'look', ...look }));
  }

  private connect_(status: LinkStatus, reason: string): void {
    const generation = ++this.generation_;
    this.welcomed_ = false;
    this.byeReason_ = '';
    this.heardMs_ = this.options.nowMs();
    this.tickMs_ = this.heardMs_;
    this.events.status(status, reason);
    const socket = this.options.open(this.options.url, VIEW_PROTOCOL);
    socket.binaryType = 'arraybuffer';
    this.socket_ = socket;
    const current = (): boolean => generation === this.generation_ && !this.stopped_;
    socket.onopen = () => {
      if (current()) socket.send(JSON.stringify({ type: 'hello', name: this.options.name }));
    };
    socket.onmessage = (event) => {
      if (current()) this.received_(event.data, current);
    };
    socket.onclose = (event) => {
      if (current()) void this.lost_(this.byeReason_ || event.reason || 'The connection to the server was lost.');
    };
    socket.onerror = () => {}; // a close event always follows and says the same
    clearInterval(this.pingTimer_);
    this.pingTimer_ = setInterval(() => this.tick_(), PING_EVERY_MS);
  }

  private drop_(): void {
    this.generation_ += 1;
    clearInterval(this.pingTimer_);
    this.socket_?.close();
    this.socket_ = null;
  }

  private async lost_(reason: string): Promise<void> {
    this.drop_();
    const generation = this.generation_;
    this.events.status('reconnecting', reason);
    const final = await this.options.probe();
    if (this.stopped_ || generation !== this.generation_) return;
    if (final !== null) {
      this.stop(final);
      return;
    }
    this.retryTimer_ = setTimeout(() => this.connect_('reconnecting', reason), this.backoff_.next());
  }

  private tick_(): void {
    const now = this.options.nowMs();
    // A page that was blocked or asleep has messages waiting; it must read them before it may call the server silent.
    if (now - this.tickMs_ > 2 * PING_EVERY_MS) this.heardMs_ = now;
    this.tickMs_ = now;
    if (now - this.heardMs_ > SILENCE_MAX_MS) {
      void this.lost_('The server does not answer.');
    } else if (this.welcomed_) {
      this.sendFrame_(FrameType.Ping, { kind: 'ping', time_us: BigInt(Math.round(now * 1000)) });
    }
  }

  private sendFrame_(type: FrameType, payload: { kind: 'ping'; time_us: bigint } | { kind: 'ack' }, sequence?: bigint): void {
    this.sequence_ += 1n;
    const header: Header = {
      type,
      flags: 0,
      epoch: this.epoch_,
      sequence: sequence ?? this.sequence_,
      time_us: BigInt(Math.round(this.options.nowMs() * 1000)),
    };
    this.socket_?.send(encodeFrame({ header, ...payload }));
  }

  private received_(data: unknown, current: () => boolean): void {
    this.heardMs_ = this.options.nowMs();
    if (typeof data === 'string') {
      this.receivedText_(data);
    } else if (data instanceof ArrayBuffer) {
      const frame = decodeFrame(data);
      if (frame.ok) this.receivedFrame_(frame.value, current);
      else this.events.problem(`A frame was rejected: ${frame.error.reason} (${frame.error.code}).`);
    }
  }

  private receivedText_(text: string): void {
    const parsed = parseControl(text);
    if (!parsed.ok) {
      this.events.problem(`A message was rejected: ${parsed.error.reason}.`);
      return;
    }
    const message = parsed.value;
    if (message === null) return; // a type of a newer server
    if (message.type === 'welcome') {
      this.welcomed_ = true;
      this.epoch_ = message.epoch;
      this.backoff_.reset();
      this.events.message(message);
      this.events.status('connected', '');
      this.tick_();
      return;
    }
    if (message.type === 'bye') this.byeReason_ = message.reason;
    this.events.message(message);
    if (message.type !== 'error' || !message.fatal) return;
    // Only what will not change by itself is final; a page that was too slow to say hello, or a full server, tries again.
    if (message.code === 'unknown_session') this.stop(message.reason);
    else void this.lost_(message.reason);
  }

  private receivedFrame_(frame: Frame, current: () => boolean): void {
    switch (frame.kind) {
      case 'tools': this.events.tools(frame.header, frame.tools); break;
      case 'mesh': this.applyMesh_(frame.header, frame.glb, current); break;
      case 'ping':
        this.socket_?.send(encodeFrame({
          header: { ...frame.header, type: FrameType.Pong },
          kind: 'pong', ping_time_us: frame.time_us, time_us: BigInt(Math.round(this.options.nowMs() * 1000)),
        }));
        break;
      case 'pong':
        this.events.pong(Number(frame.ping_time_us) / 1000, this.options.nowMs(), frame.time_us);
        break;
      default: break; // not for a viewer
    }
  }

  private applyMesh_(header: Header, glb: Uint8Array, current: () => boolean): void {
    this.applying_ = this.applying_.then(async () => {
      if (!current()) return;
      try {
        await this.events.mesh(header, glb);
      } catch (problem) {
        this.events.problem(`A mesh frame could not be applied: ${(problem as Error).message}`);
      }
      // A frame that failed is acknowledged too: the tiles come again with the next change, and the stream must not stop.
      if (current()) this.sendFrame_(FrameType.Ack, { kind: 'ack' }, header.sequence);
    });
  }
}
