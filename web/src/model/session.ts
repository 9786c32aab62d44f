// SPDX-License-Identifier: Apache-2.0
// The state of the session without any drawing: the link writes it, the views read it.

import { batch, signal } from '@preact/signals';
import type { LinkStatus } from './link_status';
import type {
  Header,
  ServerMessage,
  StateMessage,
  Stock,
  ToolInfo,
  ToolState,
  Vec3,
  Welcome,
} from '../wire/types';
import { RateMeter, ServerClock } from './clock';
import { Liveness } from './liveness';
import { Participants } from './participants';
import { PictureLag } from './picture_lag';
import { Programs } from './programs';
import { TileTable } from './tiles';
import { Together } from './together';

export interface Bounds {
  min: Vec3;
  max: Vec3;
}

export function stockBounds(stock: Stock): Bounds {
  if (stock.shape === 'box') return { min: stock.min_mm, max: stock.max_mm };
  const [x, y] = stock.center_mm;
  const r = stock.radius_mm;
  return { min: [x - r, y - r, stock.min_z_mm], max: [x + r, y + r, stock.max_z_mm] };
}

export class SessionModel {
  readonly tiles = new TileTable();
  readonly participants = new Participants();
  readonly programs = new Programs();
  readonly together = new Together();
  readonly clock = new ServerClock();
  readonly frames = new RateMeter();
  readonly liveness = new Liveness();
  readonly lag = new PictureLag();
  meshFrames = 0;
  meshBytes = 0;
  // Signals: components and effects that read the properties below run again after a change.
  private readonly welcome_ = signal<Welcome | null>(null);
  private readonly tools_ = signal<readonly ToolInfo[]>([]);
  private readonly state_ = signal<StateMessage | null>(null);
  private readonly status_ = signal<LinkStatus>('connecting');
  private readonly statusReason_ = signal('');
  private readonly problem_ = signal('');
  private readonly problems_ = signal(0);
  private lastFrameMs_ = -Infinity;
  private lastFrameUs_ = 0n;

  setStatus(status: LinkStatus, reason: string): void {
    batch(() => {
      this.status_.value = status;
      this.statusReason_.value = reason;
    });
  }

  get welcome(): Welcome | null {
    return this.welcome_.value;
  }

  get state(): StateMessage | null {
    return this.state_.value;
  }

  get status(): LinkStatus {
    return this.status_.value;
  }

  /** A sentence for the user; empty if there is no problem. */
  get statusReason(): string {
    return this.statusReason_.value;
  }

  /** The newest problem, as a sentence. */
  get problem(): string {
    return this.problem_.value;
  }

  /** Number of problems so far. */
  get problems(): number {
    return this.problems_.value;
  }

  apply(message: ServerMessage, nowMs = performance.now()): void {
    batch(() => this.apply_(message, nowMs));
  }

  private apply_(message: ServerMessage, nowMs: number): void {
    switch (message.type) {
      case 'welcome':
        this.welcome_.value = message;
        this.tools_.value = message.tools;
        this.state_.value = null;
        this.tiles.beginSnapshot();
        this.clock.reset();
        this.liveness.reset();
        this.lag.reset();
        this.participants.setList(message.participants, message.viewers);
        this.participants.forgetPoses();
        this.programs.clear();
        this.together.clear();
        break;
      case 'tools':
        this.tools_.value = message.tools;
        break;
      case 'name':
        if (this.welcome) this.welcome_.value = { ...this.welcome, name: message.name };
        break;
      case 'participants':
        this.participants.setList(message.participants, message.viewers);
        break;
      case 'participants_changed':
        this.participants.change(message);
        break;
      case 'state':
        this.state_.value = message;
        this.lag.heard(message, nowMs);
        break;
      case 'programs':
        this.programs.apply(message.programs);
        break;
      case 'pins':
        this.together.setPins(message.pins);
        break;
      case 'cameras':
        this.together.setCameras(message.cameras);
        break;
      case 'error':
        this.addProblem(`${message.reason} (${message.code})`);
        break;
      case 'bye':
        break; // the link reports the reason when the connection closes
    }
  }

  applyTools(header: Header, tools: ToolState[], nowMs: number): void {
    this.frameArrived_(header, nowMs);
    this.participants.applyTools(tools, this.clock.toLocalMs(header.time_us));
  }

  meshArrived(header: Header, bytes: number, nowMs: number): void {
    this.frameArrived_(header, nowMs);
    this.meshFrames += 1;
    this.meshBytes += bytes;
  }

  /** The answer to a ping arrived. Its round trip counts if the page did not stand still. */
  pong(sentMs: number, receivedMs: number, serverUs: bigint): void {
    if (this.liveness.answered(sentMs, receivedMs)) this.clock.pong(sentMs, receivedMs, serverUs);
  }

  addProblem(text: string): void {
    batch(() => {
      this.problem_.value = text;
      this.problems_.value = this.problems_.peek() + 1;
    });
  }

  /** Returns the time since the server sent the newest frame, ms; NaN while unknown. */
  stalenessMs(nowMs: number): number {
    if (this.lastFrameMs_ === -Infinity) return Number.NaN;
    return this.clock.ageMs(nowMs, this.lastFrameUs_);
  }

  /**
   * True if a frame arrived within the last second, so that further silence indicates a problem.
   */
  active(nowMs: number): boolean {
    return nowMs - this.lastFrameMs_ < 1000;
  }

  tool(id: number): ToolInfo | undefined {
    return this.tools.find((tool) => tool.id === id);
  }

  /** The tools of the session, with those that were made since the welcome. */
  get tools(): readonly ToolInfo[] {
    return this.tools_.value;
  }

  /** A tool was made, of which the server's list will come. */
  addTool(tool: ToolInfo): void {
    if (!this.tool(tool.id)) this.tools_.value = [...this.tools_.peek(), tool];
  }

  private frameArrived_(header: Header, nowMs: number): void {
    this.clock.arrived(nowMs, header.time_us);
    this.frames.tick(nowMs);
    this.lastFrameMs_ = nowMs;
    this.lastFrameUs_ = header.time_us;
  }
}
