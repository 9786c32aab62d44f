// SPDX-License-Identifier: Apache-2.0
// Gives the mouse buttons of the camera's controls the actions of the chosen navigation. Shift and
// Ctrl, by which the controls pan instead of turning and turn instead of panning, are theirs, but
// for zooming.

import { MOUSE } from 'three';
import type { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Chord, dragOf, NAVIGATIONS } from '../model/navigation';
import type { Drag, Navigation } from '../model/navigation';

const ACTIONS: Record<Drag, MOUSE | null> = {
  rotate: MOUSE.ROTATE,
  pan: MOUSE.PAN,
  zoom: MOUSE.DOLLY,
  none: null,
};
const FIELDS = { middle: 'MIDDLE', right: 'RIGHT' } as const;
const BUTTONS = { 1: 'middle', 2: 'right' } as const;
const MIDDLE = 1;

export class MouseButtons {
  private navigation_ = NAVIGATIONS[0]!;
  /** The last action given to each button. */
  private readonly given_: Record<'middle' | 'right', Drag> = { middle: 'zoom', right: 'pan' };
  private readonly chord_ = new Chord();
  private dragged_: Drag | null = null; // by a chord
  private restarts_ = false;

  constructor(
    private readonly controls: OrbitControls,
    private readonly element: HTMLElement,
  ) {
    // Before the controls hear of it.
    element.addEventListener('pointerdown', (event) => this.pressed_(event), { capture: true });
    element.addEventListener('pointermove', (event) => this.moved_(event), { capture: true });
    element.addEventListener('pointerup', () => this.released_(), { capture: true });
  }

  set(navigation: Navigation): void {
    for (const button of ['middle', 'right'] as const)
      if (this.isOurs_(button)) this.give_(button, navigation[button]);
    this.navigation_ = navigation;
  }

  private give_(button: 'middle' | 'right', drag: Drag): void {
    this.controls.mouseButtons[FIELDS[button]] = ACTIONS[drag];
    this.given_[button] = drag;
  }

  private pressed_(event: PointerEvent): void {
    const button = (BUTTONS as Record<number, 'middle' | 'right' | undefined>)[event.button];
    const isMouse = event.pointerType === 'mouse';
    if (!button || !isMouse || this.restarts_ || !this.isOurs_(button)) return;
    this.give_(button, dragOf(this.navigation_, button, event));
    if (button !== 'middle' || !this.navigation_.chord) return;
    this.chord_.begin();
    this.dragged_ = this.given_.middle;
  }

  /** A button that is pressed or released while another is held comes as a movement. */
  private moved_(event: PointerEvent): void {
    if (this.dragged_ === null || this.restarts_) return;
    const drag = this.chord_.drag(event.buttons, performance.now());
    if (drag === this.dragged_) return;
    this.dragged_ = drag;
    this.restarts_ = true;
    this.send_('pointerup', event);
    if (drag !== null) {
      this.give_('middle', drag);
      this.send_('pointerdown', event);
    }
    this.restarts_ = false;
  }

  private released_(): void {
    if (!this.restarts_) this.dragged_ = null;
  }

  /** The controls begin another drag by another press only. */
  private send_(type: 'pointerup' | 'pointerdown', event: PointerEvent): void {
    const { pointerId, pointerType, isPrimary, clientX, clientY, buttons } = event;
    const at = { pointerId, pointerType, isPrimary, clientX, clientY, buttons };
    this.element.dispatchEvent(
      new PointerEvent(type, { ...at, button: MIDDLE, bubbles: true, cancelable: true }),
    );
  }

  /** While one carves, the buttons have other tasks. */
  private isOurs_(button: 'middle' | 'right'): boolean {
    return this.controls.mouseButtons[FIELDS[button]] === ACTIONS[this.given_[button]];
  }
}
