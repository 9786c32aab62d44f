// SPDX-License-Identifier: Apache-2.0
// The help dialog: keyboard, mouse and touch controls.

import { t } from '../strings';
import { h } from './dom';

const KEYS: readonly [string, string][] = [
  ['F', t('Fit the block')],
  ['0', t('Three-quarter view')],
  ['1 · 3 · 7', t('Front, right, top')],
  [t('Shift + 1 · 3 · 7'), t('Back, left, bottom')],
  [t('Arrow keys'), t('Rotate')],
  [t('Shift + arrow keys'), t('Pan')],
  ['+ · −', t('Zoom')],
  ['N', t('Follow the next tool')],
  ['Esc', t('Stop following')],
  ['A', t('Force and torque arrows on or off')],
  ['G', t('Grid on or off')],
  ['S', t('Sound on or off')],
  ['T', t('Timeline: look at the past')],
  ['C', t('Carve, with mouse, pen or finger')],
  [t('Arrows on the timeline'), t('One motion, with Shift 100, Page up and down 1000')],
  ['I', t('Sections and measures')],
  ['O', t('Parallel projection or perspective')],
  [t('Ctrl + Z'), t('Undo the newest stroke of the selected participant')],
  [t('Ctrl + Shift + Z'), t('Redo')],
  ['?', t('Show this help')],
];

const CARVING: readonly [string, string][] = [
  [t('Drag, one finger'), t('Carve')],
  [t('Right drag, Space + drag, two fingers'), t('Rotate')],
  [t('Middle drag, three fingers'), t('Pan')],
  [t('Ctrl + wheel, pressure of a pen'), t('Depth')],
  ['[ · ]', t('Tool')],
  ['P · L', t('Follow the surface or a plane; lean with the surface')],
  [t('Ctrl + Z, tap with two fingers'), t('Undo your newest stroke')],
  [t('Ctrl + Shift + Z, tap with three'), t('Redo')],
  ['Esc', t('End the stroke, then carving')],
];

const POINTERS: readonly [string, string][] = [
  [t('Drag, one finger'), t('Rotate')],
  [t('Right drag, two fingers'), t('Pan')],
  [t('Wheel, pinch'), t('Zoom towards the pointer')],
  [t('Double click'), t('Center on that point')],
];

function table(rows: readonly [string, string][]): HTMLElement {
  return h(
    'dl',
    { class: 'keys' },
    ...rows.flatMap(([key, what]) => [h('dt', {}, key), h('dd', {}, what)]),
  );
}

export function helpDialog(): HTMLDialogElement {
  const close = h('button', { class: 'button' }, t('Close'));
  const dialog = h(
    'dialog',
    { class: 'help', 'aria-label': t('Keyboard and pointer') },
    // Else the button at the end has the focus, and the beginning is out of sight.
    h('h2', { tabindex: '-1', autofocus: '' }, t('Keyboard')),
    table(KEYS),
    h('h2', {}, t('Mouse, pen and touch')),
    table(POINTERS),
    h('h2', {}, t('While you carve')),
    table(CARVING),
    h('form', { method: 'dialog' }, close),
  );
  dialog.addEventListener('click', (event) => {
    if (event.target === dialog) dialog.close();
  });
  return dialog;
}
