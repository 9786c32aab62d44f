// SPDX-License-Identifier: Apache-2.0
// The viewer's connection to one session: sends hello, delivers typed events, acknowledges each
// mesh frame after it was applied (the acknowledgement is the credit for the next one), measures
// the round trip, and reconnects after a loss, also at another server.

import { t } from '../strings';
import { decodeFrame } from '../wire/decode';
import { encodeFrame } from '../wire/encode';
import { parseControl } from '../wire/control';
import { nameThatFits } from '../wire/names';
import { FrameType, VIEW_PROTOCOL } from '../wire/types';
import type {
  CameraPose,
  Frame,
  Header,
  Look,
  Seek,
  ServerMessage,
  ToolState,
} from '../wire/types';
import type { LinkStatus } from '../model/link_status';
import type { Rejection } from './api';
import { Backoff } from './backoff';
import { FrameWatch } from './frame_watch';
import { helloText } from './hello';
import { Servers } from './servers';
import { Silence } from './silence';
import type { Socket } from './socket';

export interface LinkEvents {
  /** The hello was sent. */
  greeted(): void;
  /** The server with this origin lets the viewer in. The welcome follows. */
  served(server: string): void;
  /** The server has welcomed the viewer under a name given to rename(), cut to its limit. */
  renamed(name: string): void;
  /** The status changed; `reason` is a sentence for the user, empty if there is no problem. */
  status(status: LinkStatus, reason: string): void;
  message(message: ServerMessage): void;
  tools(header: Header, tools: ToolState[]): void;
  /**
   * Applies a mesh frame. Called for one frame at a time, in order; the next frame waits for the
   * promise.
   */
  mesh(header: Header, glb: Uint8Array): Promise<void>;
  /** A ping was sent. */
  pinged(): void;
  pong(sentMs: number, receivedMs: number, serverUs: bigint): void;
  /** Whether mesh frames that the server has sent have not come. */
  late(isLate: boolean): void;
  /**
   * The server sent something invalid, or a frame could not be applied. The connection stays open.
   */
  problem(reason: string): void;
}

export interface LinkOptions {
  /** At the server that the page comes from; that one may send it on to another. */
  url: string;
  /** The viewer's name, truncated to the server's limit; rename() changes it. */
  name: string;
  open(url: string, protocol: string): Socket;
  /** Queries over HTTP why the server with this origin does not let the viewer in. */
  probe(server: string): Promise<Rejection>;
  /** Under which the viewer was there before; empty: the server chooses. */
  color?(): string;
  /**
   * The camera, once the block has been seen. It stands in the hello, so that the first snapshot
   * has the right levels of detail. Before, null: a look follows the welcome.
   */
  look(): Look | null;
  /** Bytes of the surface per second that the server may send; 0: any; missing: the page's. */
  budget?: number;
  /**
   * Leaves this page for that of a server which lets in only its own, when no other one does. False:
   * it may not be followed, and the link goes on trying.
   */
  reloadAt(server: string): boolean;
  /** Resolves when another mesh frame is of use: one is acknowledged then. Missing: at once. */
  needsTiles?(): Promise<void>;
  nowMs(): number;
  backoff?: Backoff;
}

/** Connections that are not accepted before the page is left for that of another server. */
const ATTEMPTS_BEFORE_RELOADING = 3;
const PING_EVERY_MS = 2000;
/** After a damaged stream of mesh frames: how long the next one waits longer each time. */
const CALM_MS = 60_000;

export class ViewLink {
  private socket_: Socket | null = null;
  private generation_ = 0; // counts connections; events of earlier ones are ignored
  private applying_: Promise<void> = Promise.resolve();
  private epoch_ = 0;
  private sequence_ = 0n;
  private readonly silence_ = new Silence(PING_EVERY_MS);
  private readonly watch_ = new FrameWatch();
  private faultMs_ = -Infinity; // of the last damaged or missing mesh frame
  private readonly servers_: Servers;
  private bye_ = { reason: '', redirect: '' };
  private forItsPage_: string | null = null; // the server that lets in only pages of its own
  private failures_ = 0; // connections since the last welcome that were not accepted
  private welcomed_ = false;
  private blocks_ = 0; // counts welcomes: each begins another block
  private stopped_ = false;
  private pingTimer_: ReturnType<typeof setInterval> | undefined;
  private retryTimer_: ReturnType<typeof setTimeout> | undefined;
  private retryAtMs_: number | null = null;
  private name_: string;
  private chosen_: string | null = null; // by rename(), not welcomed yet
  private readonly backoff_: Backoff;

  constructor(
    private readonly options: LinkOptions,
    private readonly events: LinkEvents,
  ) {
    this.backoff_ = options.backoff ?? new Backoff();
    this.servers_ = new Servers(options.url);
    this.name_ = nameThatFits(options.name);
  }

  start(): void {
    this.stopped_ = false;
    this.connect_('connecting', '');
  }

  /** Closes the connection and does not reconnect. */
  stop(reason = ''): void {
    this.stopped_ = true;
    this.drop_();
    clearTimeout(this.retryTimer_);
    this.events.status('stopped', reason);
  }

  /** When the next attempt to connect begins, by the clock of `nowMs`; null: none is waiting. */
  get retryAtMs(): number | null {
    return this.retryAtMs_;
  }

  /** Under which the viewer joins. */
  get name(): string {
    return this.name_;
  }

  /** Joins again under another name: participants keep theirs as long as they are connected. */
  rename(name: string): void {
    this.name_ = nameThatFits(name);
    this.chosen_ = this.name_;
    if (this.stopped_ || !this.socket_) return;
    this.drop_();
    this.connect_('reconnecting', t('Changing your name.'));
  }

  /** Reconnects now instead of after the backoff delay, e.g. when the device is online again. */
  retryNow(): void {
    if (this.stopped_ || this.socket_) return;
    clearTimeout(this.retryTimer_);
    this.connect_('reconnecting', '');
  }

  /**
   * Sends the camera position and the acceptable error to the server. Does nothing before the
   * welcome.
   */
  sendLook(look: Look): void {
    if (this.welcomed_) this.socket_?.send(JSON.stringify({ type: 'look', ...look }));
  }

  /** Asks for the block of a point in the past. Does nothing before the welcome. */
  seek(seek: Seek): void {
    if (this.welcomed_) this.socket_?.send(JSON.stringify(seek));
  }

  /** Shows the camera to the other viewers; null: no longer. Does nothing before the welcome. */
  showCamera(pose: CameraPose | null): void {
    if (this.welcomed_) this.socket_?.send(JSON.stringify({ type: 'camera', ...pose }));
  }

  private connect_(status: LinkStatus, reason: string): void {
    const generation = ++this.generation_;
    this.welcomed_ = false;
    this.retryAtMs_ = null;
    this.bye_ = { reason: '', redirect: '' };
    this.silence_.begin(this.options.nowMs());
    this.events.status(status, reason);
    const socket = this.options.open(this.servers_.url, VIEW_PROTOCOL);
    socket.binaryType = 'arraybuffer';
    this.socket_ = socket;
    const current = (): boolean => generation === this.generation_ && !this.stopped_;
    socket.onopen = () => {
      if (!current()) return;
      if (!socket.isGreeted) socket.send(this.hello_());
      this.events.greeted();
    };
    socket.onmessage = (event) => {
      if (current()) this.received_(event.data, current);
    };
    socket.onclose = (event) => {
      if (current())
        void this.lost_(
          this.bye_.reason || event.reason || t('The connection to the server was lost.'),
        );
    };
    socket.onerror = () => {
      // A close event always follows and carries the reason.
    };
    clearInterval(this.pingTimer_);
    this.pingTimer_ = setInterval(() => this.tick_(), PING_EVERY_MS);
  }

  private hello_(): string {
    const { options } = this;
    return helloText(this.name_, options.look(), options.budget, options.color?.());
  }

  private drop_(): void {
    this.generation_ += 1;
    clearInterval(this.pingTimer_);
    this.socket_?.close();
    this.socket_ = null;
  }

  private async lost_(reason: string): Promise<void> {
    const { server } = this.servers_;
    const isNamed = this.servers_.lost(this.bye_.redirect, this.welcomed_);
    this.drop_();
    if (isNamed) {
      this.connect_('reconnecting', reason);
      return;
    }
    const generation = this.generation_;
    this.events.status('reconnecting', reason);
    const { final, isForItsPage } = await this.options.probe(server);
    if (this.stopped_ || generation !== this.generation_) return;
    if (final !== undefined) {
      this.stop(final);
      return;
    }
    if (isForItsPage) this.forItsPage_ = server;
    if (this.leaves_()) return;
    const delayMs = this.backoff_.next();
    this.retryAtMs_ = this.options.nowMs() + delayMs;
    this.retryTimer_ = setTimeout(() => this.connect_('reconnecting', reason), delayMs);
  }

  /** Loads the page of another server if nothing else is left. */
  private leaves_(): boolean {
    this.failures_ += 1;
    if (this.forItsPage_ === null || this.failures_ <= ATTEMPTS_BEFORE_RELOADING) return false;
    return this.options.reloadAt(this.forItsPage_);
  }

  private tick_(): void {
    const now = this.options.nowMs();
    if (this.silence_.tick(now)) {
      void this.lost_(t('The server stopped answering.'));
    } else if (this.welcomed_) {
      this.events.pinged();
      this.sendFrame_(FrameType.Ping, { kind: 'ping', time_us: BigInt(Math.round(now * 1000)) });
    }
  }

  private sendFrame_(
    type: FrameType,
    payload: { kind: 'ping'; time_us: bigint } | { kind: 'ack' },
    sequence?: bigint,
  ): void {
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
    this.silence_.heard(this.options.nowMs());
    if (typeof data === 'string') {
      this.receivedText_(data);
    } else if (data instanceof ArrayBuffer) {
      const frame = decodeFrame(data);
      if (frame.ok) this.receivedFrame_(frame.value, current);
      else {
        const { reason, code } = frame.error;
        this.events.problem(
          t('The page could not read data from the server: {0} ({1}).', reason, code),
        );
        if (this.watch_.watches) this.broken_();
      }
    }
  }

  private receivedText_(text: string): void {
    const parsed = parseControl(text);
    if (!parsed.ok) {
      this.events.problem(
        t('The page could not read a message from the server: {0}.', parsed.error.reason),
      );
      return;
    }
    const message = parsed.value;
    if (message === null) return; // unknown type, from a newer server
    if (message.type === 'welcome') {
      this.welcomed_ = true;
      this.blocks_ += 1;
      this.servers_.welcomed(message.others ?? []);
      this.forItsPage_ = null;
      this.failures_ = 0;
      this.epoch_ = message.epoch;
      if (this.options.nowMs() - this.faultMs_ > CALM_MS) this.backoff_.reset();
      this.watch_.begin(message.meshes);
      this.events.late(false);
      if (this.chosen_ !== null) this.events.renamed(this.chosen_);
      this.chosen_ = null;
      this.events.served(this.servers_.server);
      this.events.message(message);
      this.events.status('connected', '');
      this.tick_();
      return;
    }
    if (message.type === 'bye')
      this.bye_ = { reason: message.reason, redirect: message.redirect ?? '' };
    this.events.message(message);
    if (message.type !== 'error' || !message.fatal) return;
    // Retry after errors that may pass, such as a late hello or a full server; only a missing
    // session is final.
    if (message.code === 'unknown_session') this.stop(message.reason);
    else void this.lost_(message.reason);
  }

  private receivedFrame_(frame: Frame, current: () => boolean): void {
    switch (frame.kind) {
      case 'tools':
        this.events.tools(frame.header, frame.tools);
        break;
      case 'mesh':
        if (this.watch_.isNext(frame.header)) this.applyMesh_(frame.header, frame.glb, current);
        else this.broken_();
        break;
      case 'ping':
        this.socket_?.send(
          encodeFrame({
            header: { ...frame.header, type: FrameType.Pong },
            kind: 'pong',
            ping_time_us: frame.time_us,
            time_us: BigInt(Math.round(this.options.nowMs() * 1000)),
          }),
        );
        break;
      case 'pong':
        this.events.pong(Number(frame.ping_time_us) / 1000, this.options.nowMs(), frame.time_us);
        this.watch_.sent(frame.header.durable_sequence ?? 0n);
        this.events.late(this.watch_.isLate);
        if (this.watch_.isLost) this.broken_();
        break;
      default:
        break; // other frame types are not meant for viewers
    }
  }

  /** The picture cannot be completed: joins again, which brings all tiles. */
  private broken_(): void {
    this.faultMs_ = this.options.nowMs();
    void this.lost_(t('Part of the view was lost or damaged in transit.'));
  }

  private applyMesh_(header: Header, glb: Uint8Array, current: () => boolean): void {
    const block = this.blocks_;
    this.applying_ = this.applying_.then(async () => {
      if (!current() || block !== this.blocks_) return; // of the block before a seek
      try {
        await this.events.mesh(header, glb);
      } catch (problem) {
        this.events.problem(
          t('Part of the block could not be shown: {0}', (problem as Error).message),
        );
      }
      // Failed frames are acknowledged too: without credit the stream would stop; their tiles are
      // sent again when they change.
      const ready = this.options.needsTiles?.() ?? Promise.resolve();
      void ready.then(() => {
        if (current()) this.sendFrame_(FrameType.Ack, { kind: 'ack' }, header.sequence);
      });
    });
  }
}
