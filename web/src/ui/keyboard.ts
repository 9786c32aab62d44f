// SPDX-License-Identifier: Apache-2.0
// Keyboard shortcuts (help.tsx lists them for the user).

import type { Preset } from '../view/camera_rig';
import type { Action } from './actions';

/** Moves of the camera by keys. */
export interface CameraKeys {
  preset: (preset: Preset) => void;
  orbit: (aroundRad: number, upRad: number) => void;
  pan: (right: number, up: number) => void;
  zoom: (factor: number) => void;
}

const TURN_RAD = Math.PI / 24;
const PAN_FRACTION = 0.06; // of the view's height
const ZOOM_FACTOR = 0.87;

/**
 * Views by the key's physical position, because Shift + 1 yields other characters on other keyboard
 * layouts.
 */
const VIEWS: Record<string, [plain: Preset, shifted: Preset]> = {
  Digit0: ['iso', 'iso'],
  Numpad0: ['iso', 'iso'],
  Digit1: ['front', 'back'],
  Numpad1: ['front', 'back'],
  Digit3: ['right', 'left'],
  Numpad3: ['right', 'left'],
  Digit7: ['top', 'bottom'],
  Numpad7: ['top', 'bottom'],
};

const ARROWS: Record<string, [x: number, y: number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

const ZOOMS: Record<string, number> = {
  '+': ZOOM_FACTOR,
  '=': ZOOM_FACTOR,
  '-': 1 / ZOOM_FACTOR,
  _: 1 / ZOOM_FACTOR,
};

/** The move of the camera that a key means; null: none. */
function moveOf(event: KeyboardEvent, camera: CameraKeys): (() => void) | null {
  const view = VIEWS[event.code];
  if (view) return () => camera.preset(view[event.shiftKey ? 1 : 0]);
  const arrow = ARROWS[event.key];
  if (arrow)
    return event.shiftKey
      ? () => camera.pan(arrow[0] * PAN_FRACTION, arrow[1] * PAN_FRACTION)
      : () => camera.orbit(arrow[0] * TURN_RAD, arrow[1] * TURN_RAD);
  const zoom = ZOOMS[event.key];
  return zoom === undefined ? null : () => camera.zoom(zoom);
}

function isCommand(event: KeyboardEvent): boolean {
  return event.ctrlKey || event.metaKey || event.altKey;
}

/**
 * A key as Action.key names it. Cmd of a Mac is Ctrl, and Ctrl+Y is Ctrl+Shift+Z; combinations that
 * no action has belong to the browser.
 */
function nameOf(event: KeyboardEvent): string {
  const key = event.key.length === 1 ? event.key.toUpperCase() : event.key;
  if (!isCommand(event)) return key;
  if (event.altKey) return `Alt+${key}`;
  if (key === 'Y') return 'Ctrl+Shift+Z';
  return event.shiftKey ? `Ctrl+Shift+${key}` : `Ctrl+${key}`;
}

/**
 * Handles key presses on the whole page, except in input fields and dialogs, and except browser
 * shortcuts.
 */
export function listenToKeys(camera: CameraKeys, actions: readonly Action[]): void {
  window.addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    if (target.closest('input, textarea, select, dialog')) return;
    const move = isCommand(event) ? null : moveOf(event, camera);
    const perform = move ?? actions.find(({ key }) => key === nameOf(event))?.perform;
    if (!perform) return;
    event.preventDefault();
    perform();
  });
}
