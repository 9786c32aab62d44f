// SPDX-License-Identifier: Apache-2.0
// Keyboard shortcuts (help.ts lists them for the user).

import type { Preset } from '../view/camera_rig';

export interface KeyActions {
  preset: (preset: Preset) => void;
  fit: () => void;
  orbit: (aroundRad: number, upRad: number) => void;
  pan: (right: number, up: number) => void;
  zoom: (factor: number) => void;
  followNext: () => void;
  followNone: () => void;
  toggleArrows: () => void;
  toggleGrid: () => void;
  toggleSound: () => void;
  toggleTimeline: () => void;
  toggleInspect: () => void;
  toggleParallel: () => void;
  toggleCarve: () => void;
  undo: () => void;
  redo: () => void;
  help: () => void;
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

function actionOf(event: KeyboardEvent, actions: KeyActions): (() => void) | null {
  const view = VIEWS[event.code];
  if (view) return () => actions.preset(view[event.shiftKey ? 1 : 0]);
  const arrow = ARROWS[event.key];
  if (arrow) {
    return event.shiftKey
      ? () => actions.pan(arrow[0] * PAN_FRACTION, arrow[1] * PAN_FRACTION)
      : () => actions.orbit(arrow[0] * TURN_RAD, arrow[1] * TURN_RAD);
  }
  switch (event.key) {
    case 'f':
    case 'F':
      return actions.fit;
    case '+':
    case '=':
      return () => actions.zoom(ZOOM_FACTOR);
    case '-':
    case '_':
      return () => actions.zoom(1 / ZOOM_FACTOR);
    case 'n':
    case 'N':
      return actions.followNext;
    case 'Escape':
      return actions.followNone;
    case 'a':
    case 'A':
      return actions.toggleArrows;
    case 'g':
    case 'G':
      return actions.toggleGrid;
    case 's':
    case 'S':
      return actions.toggleSound;
    case 't':
    case 'T':
      return actions.toggleTimeline;
    case 'i':
    case 'I':
      return actions.toggleInspect;
    case 'o':
    case 'O':
      return actions.toggleParallel;
    case 'c':
    case 'C':
      return actions.toggleCarve;
    case '?':
      return actions.help;
    default:
      return null;
  }
}

function isCommand(event: KeyboardEvent): boolean {
  return event.ctrlKey || event.metaKey || event.altKey;
}

/** Ctrl (on a Mac, Cmd) with Z, Shift + Z or Y; other combinations belong to the browser. */
function commandOf(event: KeyboardEvent, actions: KeyActions): (() => void) | null {
  if (event.altKey) return null;
  const key = event.key.toLowerCase();
  if (key === 'z') return event.shiftKey ? actions.redo : actions.undo;
  return key === 'y' ? actions.redo : null;
}

const NOTHING = (): void => undefined;

/** Those of a page that shows nothing but the picture, in the frame of another site. */
export function withoutPanels(actions: KeyActions): KeyActions {
  return {
    ...actions,
    toggleTimeline: NOTHING,
    toggleInspect: NOTHING,
    toggleCarve: NOTHING,
    undo: NOTHING,
    redo: NOTHING,
    help: NOTHING,
  };
}

/**
 * Handles key presses on the whole page, except in input fields and dialogs, and except browser
 * shortcuts.
 */
export function listenToKeys(actions: KeyActions): void {
  window.addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    if (target.closest('input, textarea, select, dialog')) return;
    const action = isCommand(event) ? commandOf(event, actions) : actionOf(event, actions);
    if (!action) return;
    event.preventDefault();
    action();
  });
}
