// SPDX-License-Identifier: Apache-2.0
// Fingers on the picture: one carves; two turn and zoom, three pan; a tap of two undoes, of three
// redoes. The first finger waits a moment before it carves, because a second one may follow. One that
// rests where it began holds the plane there.

export interface TouchActions {
  begin(x: number, y: number): void;
  move(places: readonly (readonly [x: number, y: number])[]): void;
  end(): void;
  /** The finger has begun and rests: its stroke stays on the plane there. */
  holdPlane(): void;
  /** Pixels that the fingers have moved to the right and down, and by how much they are closer. */
  turn(dx: number, dy: number, closer: number): void;
  pan(dx: number, dy: number): void;
  undo(): void;
  redo(): void;
}

const WAIT_MS = 90;
const STILL_PX = 10;
const TAP_MS = 350;
const HOLD_MS = 600;

interface Finger {
  x: number;
  y: number;
  fromX: number;
  fromY: number;
}

export class Touches {
  private readonly fingers_ = new Map<number, Finger>();
  private state_: 'idle' | 'waiting' | 'carving' | 'gesture' = 'idle';
  private most_ = 0;
  private sinceMs_ = 0;
  private moved_ = false;
  private timer_: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly actions: TouchActions,
    private readonly nowMs: () => number = () => performance.now(),
  ) {}

  down(id: number, x: number, y: number): void {
    if (this.fingers_.size === 0) {
      this.most_ = 0;
      this.moved_ = false;
      this.sinceMs_ = this.nowMs();
      this.state_ = 'waiting';
      this.timer_ = setTimeout(() => this.begin_(), WAIT_MS);
    } else {
      clearTimeout(this.timer_);
      if (this.state_ === 'carving') this.actions.end();
      this.state_ = 'gesture';
    }
    this.fingers_.set(id, { x, y, fromX: x, fromY: y });
    this.most_ = Math.max(this.most_, this.fingers_.size);
  }

  /** `places`: where the finger has been since the last call, the newest last. */
  move(id: number, places: readonly (readonly [x: number, y: number])[]): void {
    const finger = this.fingers_.get(id);
    const last = places.at(-1);
    if (!finger || !last) return;
    const before = this.spread_();
    const [dx, dy] = [last[0] - finger.x, last[1] - finger.y];
    [finger.x, finger.y] = last;
    if (Math.hypot(finger.x - finger.fromX, finger.y - finger.fromY) > STILL_PX) this.moved_ = true;
    if (this.state_ === 'waiting' && this.moved_) this.begin_();
    if (this.state_ === 'carving') this.actions.move(places);
    else if (this.state_ === 'gesture' && this.moved_) this.gesture_(dx, dy, before);
  }

  up(id: number): void {
    if (this.state_ === 'waiting') this.begin_(); // a tap of one finger is a short stroke
    clearTimeout(this.timer_);
    if (!this.fingers_.delete(id)) return;
    if (this.state_ === 'carving') this.actions.end();
    if (this.fingers_.size > 0) {
      this.state_ = 'gesture';
      return;
    }
    const isTap = !this.moved_ && this.nowMs() - this.sinceMs_ < TAP_MS;
    if (isTap && this.most_ === 2) this.actions.undo();
    if (isTap && this.most_ === 3) this.actions.redo();
    this.state_ = 'idle';
  }

  /** The browser has taken the fingers away. */
  cancel(): void {
    clearTimeout(this.timer_);
    if (this.state_ === 'carving') this.actions.end();
    this.fingers_.clear();
    this.state_ = 'idle';
  }

  private begin_(): void {
    clearTimeout(this.timer_);
    this.state_ = 'carving';
    for (const { fromX, fromY } of this.fingers_.values()) this.actions.begin(fromX, fromY);
    this.timer_ = setTimeout(() => {
      if (this.state_ === 'carving' && !this.moved_) this.actions.holdPlane();
    }, HOLD_MS);
  }

  private gesture_(dx: number, dy: number, before: number): void {
    const share = 1 / this.fingers_.size;
    if (this.fingers_.size === 2) {
      const after = this.spread_();
      this.actions.turn(dx * share, dy * share, after > 0 && before > 0 ? before / after : 1);
    } else if (this.fingers_.size === 3) {
      this.actions.pan(dx * share, dy * share);
    }
  }

  /** How far two fingers are apart, pixels. */
  private spread_(): number {
    const [a, b] = [...this.fingers_.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }
}
