// SPDX-License-Identifier: Apache-2.0
// Gives the mouse buttons of the camera's controls what the chosen navigation says. Shift and Ctrl,
// by which the controls pan instead of turning and turn instead of panning, are theirs, but for
// zooming.

import { MOUSE } from 'three';
import type { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { dragOf, NAVIGATIONS } from '../model/navigation';
import type { Drag, Navigation } from '../model/navigation';

const ACTIONS: Record<Drag, MOUSE> = {
  rotate: MOUSE.ROTATE,
  pan: MOUSE.PAN,
  zoom: MOUSE.DOLLY,
};
const FIELDS = { middle: 'MIDDLE', right: 'RIGHT' } as const;
const BUTTONS = { 1: 'middle', 2: 'right' } as const;

export class MouseButtons {
  private navigation_ = NAVIGATIONS[0]!;

  constructor(
    private readonly controls: OrbitControls,
    element: HTMLElement,
  ) {
    // Before the controls hear of it.
    element.addEventListener('pointerdown', (event) => this.pressed_(event), { capture: true });
  }

  set(navigation: Navigation): void {
    const { mouseButtons } = this.controls;
    for (const [button, field] of Object.entries(FIELDS) as ['middle' | 'right', 'MIDDLE'][])
      if (this.isOurs_(button)) mouseButtons[field] = ACTIONS[navigation[button]];
    this.navigation_ = navigation;
  }

  private pressed_(event: PointerEvent): void {
    const button = (BUTTONS as Record<number, 'middle' | 'right' | undefined>)[event.button];
    if (!button || event.pointerType !== 'mouse' || !this.isOurs_(button)) return;
    this.controls.mouseButtons[FIELDS[button]] = ACTIONS[dragOf(this.navigation_, button, event)];
  }

  /** While one carves, the buttons have other tasks. */
  private isOurs_(button: 'middle' | 'right'): boolean {
    const now = this.controls.mouseButtons[FIELDS[button]];
    const { [button]: usual, zoom } = this.navigation_;
    return now === ACTIONS[usual] || (zoom?.button === button && now === MOUSE.DOLLY);
  }
}
