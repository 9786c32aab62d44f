// SPDX-License-Identifier: Apache-2.0
// The keyboard map (help.ts shows it to the user).

import type { Preset } from '../view/camera_rig';

export interface KeyActions {
  preset(preset: Preset): void;
  fit(): void;
  orbit(aroundRad: number, upRad: number): void;
  pan(right: number, up: number): void;
  zoom(factor: number): void;
  followNext(): void;
  followNone(): void;
  toggleArrows(): void;
  toggleGrid(): void;
  help(): void;
}

const TURN_RAD = Math.PI / 24;
const SHIFT_PART = 0.06;
const ZOOM_FACTOR = 0.87;

/** Views by the key's place, so that Shift + 1 is found on any keyboard layout. */
const VIEWS: Record<string, [plain: Preset, shifted: Preset]> = {
  Digit0: ['iso', 'iso'], Numpad0: ['iso', 'iso'],
  Digit1: ['front', 'back'], Numpad1: ['front', 'back'],
  Digit3: ['right', 'left'], Numpad3: ['right', 'left'],
  Digit7: ['top', 'bottom'], Numpad7: ['top', 'bottom'],
};

const ARROWS: Record<string, [x: number, y: number]> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};

function actionOf(event: KeyboardEvent, actions: KeyActions): (() => void) | null {
  const view = VIEWS[event.code];
  if (view) return () => actions.preset(view[event.shiftKey ? 1 : 0]);
  const arrow = ARROWS[event.key];
  if (arrow) {
    return event.shiftKey
      ? () => actions.pan(arrow[0] * SHIFT_PART, arrow[1] * SHIFT_PART)
      : () => actions.orbit(arrow[0] * TURN_RAD, arrow[1] * TURN_RAD);
  }
  switch (event.key) {
    case 'f': case 'F': return actions.fit;
    case '+': case '=': return () => actions.zoom(ZOOM_FACTOR);
    case '-': case '_': return () => actions.zoom(1 / ZOOM_FACTOR);
    case 'n': case 'N': return actions.followNext;
    case 'Escape': return actions.followNone;
    case 'a': case 'A': return actions.toggleArrows;
    case 'g': case 'G': return actions.toggleGrid;
    case '?': return actions.help;
    default: return null;
  }
}

/** Listens on the whole page, but leaves fields, dialogs and browser shortcuts alone. */
export function listenToKeys(actions: KeyActions): void {
  window.addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (target.closest('input, textarea, select, dialog')) return;
    const action = actionOf(event, actions);
    if (!action) return;
    event.preventDefault();
    action();
  });
}
