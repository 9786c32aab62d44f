// SPDX-License-Identifier: Apache-2.0
// Mouse, pen and fingers over the picture while one carves. Events that carve do not reach the
// camera's controls. The controls get the other buttons, and all events while Space is held.

import type { Place } from './place';
import { Straight } from './straight';
import { Touches } from './touches';

export interface PointerActions {
  /** The pointer is over the picture without touching; null: it has left. */
  hover(place: Place | null): void;
  /** `onPlane`: the stroke stays on the plane on which it begins. */
  begin(place: Place, onPlane: boolean): void;
  /** From here to its end the stroke stays on the plane on which it has begun. */
  holdPlane(): void;
  /** Where the pointer has been since the last call, the newest last. */
  move(places: readonly Place[]): void;
  end(): void;
  /** Changes the depth by a factor. */
  deepen(factor: number): void;
  /** Turns the camera by pixels, and changes its distance by a factor. */
  turn(dx: number, dy: number, closer: number): void;
  pan(dx: number, dy: number): void;
  undo(): void;
  redo(): void;
}

const DEPTH_PER_WHEEL = 1 / 700;
const TILT_MAX_DEG = 85;

/** From the angles of a pen's planes with the vertical ones through the picture's axes. */
function tiltOf({ tiltX, tiltY }: PointerEvent): Place['tilt'] {
  if (tiltX === 0 && tiltY === 0) return null;
  const [right, down] = [tiltX, tiltY].map((degrees) => {
    const angle = Math.max(-TILT_MAX_DEG, Math.min(TILT_MAX_DEG, degrees));
    return Math.tan((angle * Math.PI) / 180);
  }) as [number, number];
  const length = Math.hypot(right, down, 1);
  return [right / length, down / length];
}

function placeOf(event: PointerEvent): Place {
  const isPen = event.pointerType === 'pen';
  const [pressure, tilt] = isPen ? [event.pressure, tiltOf(event)] : [null, null];
  return { x: event.offsetX, y: event.offsetY, pressure, tilt };
}

function fingerAt(x: number, y: number): Place {
  return { x, y, pressure: null, tilt: null };
}

/** The places between two frames, which browsers deliver in one event. */
function placesOf(event: PointerEvent): Place[] {
  const events = event.getCoalescedEvents();
  return (events.length > 0 ? events : [event]).map(placeOf);
}

export class Pointers {
  private stroke_: number | null = null; // the pointer that carves
  private spaceHeld_ = false;
  private last_: Place | null = null; // of the stroke
  private straight_: Straight | null = null; // while Shift is held
  private readonly touches_: Touches;
  private readonly stop_ = new AbortController();

  constructor(
    private readonly canvas: HTMLElement,
    private readonly actions: PointerActions,
  ) {
    this.touches_ = new Touches({
      ...actions,
      begin: (x, y) => actions.begin(fingerAt(x, y), false),
      move: (places) => actions.move(places.map(([x, y]) => fingerAt(x, y))),
    });
    this.listen_('pointerdown', (event) => this.down_(event));
    this.listen_('pointermove', (event) => this.move_(event));
    this.listen_('pointerup', (event) => this.up_(event));
    this.listen_('pointercancel', (event) => this.up_(event));
    this.listen_('pointerleave', () => {
      if (this.stroke_ === null) actions.hover(null);
    });
    const options = { capture: true, signal: this.stop_.signal };
    canvas.addEventListener('wheel', (event) => this.wheel_(event), { ...options, passive: false });
    canvas.addEventListener('dblclick', (event) => event.stopImmediatePropagation(), options);
  }

  set spaceHeld(held: boolean) {
    this.spaceHeld_ = held;
    if (held) this.actions.hover(null);
  }

  /** Ends the stroke, if there is one; returns whether there was. */
  cancel(): boolean {
    this.touches_.cancel();
    if (this.stroke_ === null) return false;
    this.stroke_ = null;
    this.actions.end();
    return true;
  }

  dispose(): void {
    this.cancel();
    this.stop_.abort();
  }

  private listen_(
    name: 'pointerdown' | 'pointermove' | 'pointerup' | 'pointercancel' | 'pointerleave',
    act: (event: PointerEvent) => void,
  ): void {
    this.canvas.addEventListener(name, act, { capture: true, signal: this.stop_.signal });
  }

  private down_(event: PointerEvent): void {
    if (event.pointerType === 'touch') {
      event.stopImmediatePropagation();
      this.touches_.down(event.pointerId, event.offsetX, event.offsetY);
      return;
    }
    if (event.button !== 0 || this.spaceHeld_ || this.stroke_ !== null) return;
    event.stopImmediatePropagation();
    this.stroke_ = event.pointerId;
    this.canvas.setPointerCapture(event.pointerId);
    this.last_ = placeOf(event);
    this.straight_ = null;
    this.actions.begin(this.last_, event.altKey);
  }

  private move_(event: PointerEvent): void {
    if (event.pointerType === 'touch') {
      event.stopImmediatePropagation();
      const places = placesOf(event).map(({ x, y }) => [x, y] as const);
      this.touches_.move(event.pointerId, places);
    } else if (event.pointerId === this.stroke_) {
      event.stopImmediatePropagation();
      this.strokeTo_(event);
    } else if (event.buttons === 0 && !this.spaceHeld_) {
      this.actions.hover(placeOf(event));
    } else {
      this.actions.hover(null); // the camera moves
    }
  }

  /** With Shift the stroke goes on along a straight line. */
  private strokeTo_(event: PointerEvent): void {
    const places = placesOf(event);
    if (!event.shiftKey) this.straight_ = null;
    else if (this.last_) this.straight_ ??= new Straight(this.last_);
    const { straight_: straight } = this;
    const to = straight
      ? places.map((place) => straight.along(place)).filter((place) => place !== null)
      : places;
    this.last_ = to.at(-1) ?? this.last_;
    if (to.length > 0) this.actions.move(to);
  }

  private up_(event: PointerEvent): void {
    if (event.pointerType === 'touch') {
      event.stopImmediatePropagation();
      if (event.type === 'pointercancel') this.touches_.cancel();
      else this.touches_.up(event.pointerId);
    } else if (event.pointerId === this.stroke_) {
      event.stopImmediatePropagation();
      this.stroke_ = null;
      this.actions.end();
    }
  }

  private wheel_(event: WheelEvent): void {
    if (!event.ctrlKey) return;
    event.preventDefault(); // the browser's zoom
    event.stopImmediatePropagation();
    this.actions.deepen(Math.exp(-event.deltaY * DEPTH_PER_WHEEL));
  }
}
