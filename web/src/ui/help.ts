// SPDX-License-Identifier: Apache-2.0
// The help dialog: keyboard, mouse and touch controls.

import { h } from './dom';

const KEYS: readonly [string, string][] = [
  ['F', 'Fit the block'],
  ['0', 'Three-quarter view'],
  ['1 · 3 · 7', 'Front, right, top'],
  ['Shift + 1 · 3 · 7', 'Back, left, bottom'],
  ['Arrow keys', 'Rotate'],
  ['Shift + arrow keys', 'Pan'],
  ['+ · −', 'Zoom'],
  ['N', 'Follow the next tool'],
  ['Esc', 'Stop following'],
  ['A', 'Force and torque arrows on or off'],
  ['G', 'Grid on or off'],
  ['S', 'Sound on or off'],
  ['T', 'Timeline: look at the past'],
  ['C', 'Carve, with mouse, pen or finger'],
  ['Arrows on the timeline', 'One motion, with Shift 100, Page up and down 1000'],
  ['I', 'Sections and measures'],
  ['O', 'Parallel projection or perspective'],
  ['Ctrl + Z', 'Undo the newest stroke of the selected participant'],
  ['Ctrl + Shift + Z', 'Redo'],
  ['?', 'Show this help'],
];

const CARVING: readonly [string, string][] = [
  ['Drag, one finger', 'Carve'],
  ['Right drag, Space + drag, two fingers', 'Rotate'],
  ['Middle drag, three fingers', 'Pan'],
  ['Ctrl + wheel, pressure of a pen', 'Depth'],
  ['[ · ]', 'Tool'],
  ['P · L', 'Follow the surface or a plane; lean with the surface'],
  ['Ctrl + Z, tap with two fingers', 'Undo your newest stroke'],
  ['Ctrl + Shift + Z, tap with three', 'Redo'],
  ['Esc', 'End the stroke, then carving'],
];

const POINTERS: readonly [string, string][] = [
  ['Drag, one finger', 'Rotate'],
  ['Right drag, two fingers', 'Pan'],
  ['Wheel, pinch', 'Zoom towards the pointer'],
  ['Double click', 'Center on that point'],
];

function table(rows: readonly [string, string][]): HTMLElement {
  return h(
    'dl',
    { class: 'keys' },
    ...rows.flatMap(([key, what]) => [h('dt', {}, key), h('dd', {}, what)]),
  );
}

export function helpDialog(): HTMLDialogElement {
  const close = h('button', { class: 'button' }, 'Close');
  const dialog = h(
    'dialog',
    { class: 'help', 'aria-label': 'Keyboard and pointer' },
    h('h2', {}, 'Keyboard'),
    table(KEYS),
    h('h2', {}, 'Mouse, pen and touch'),
    table(POINTERS),
    h('h2', {}, 'While you carve'),
    table(CARVING),
    h('form', { method: 'dialog' }, close),
  );
  dialog.addEventListener('click', (event) => {
    if (event.target === dialog) dialog.close();
  });
  return dialog;
}
