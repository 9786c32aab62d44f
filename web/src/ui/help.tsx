// SPDX-License-Identifier: Apache-2.0
// The help dialog: keyboard, mouse and touch controls.

import type { Signal } from '@preact/signals';
import { Fragment } from 'preact';
import { t } from '../strings';
import type { ButtonAction } from './actions';
import { Dialog } from './dialog';
import { ICONS } from './icons';

/** Whether the page is one file, without the manual (vite.single.config.ts). */
declare const KERF_IS_SINGLE: boolean;

const KEYS: readonly [string, string][] = [
  ['F', t('Show the whole block')],
  ['0', t('Three-quarter view')],
  ['1 · 3 · 7', t('Front, right, top')],
  [t('Shift + 1 · 3 · 7'), t('Back, left, bottom')],
  [t('Arrow keys'), t('Rotate')],
  [t('Shift + arrow keys'), t('Pan')],
  ['+ · −', t('Zoom')],
  ['N', t('Follow the next tool')],
  ['Esc', t('Stop following')],
  ['A', t('Show or hide force and torque arrows')],
  ['G', t('Show or hide the grid')],
  ['S', t('Turn sound on or off')],
  ['T', t('Open the timeline')],
  ['C', t('Carve with mouse, pen or finger')],
  [t('Arrow keys on the timeline'), t('One step; with Shift 100, Page up and down 1000')],
  ['I', t('Sections and measurements')],
  ['O', t('Switch between parallel and perspective view')],
  [t('Ctrl + Z'), t('Undo the last stroke of the selected participant')],
  [t('Ctrl + Shift + Z'), t('Redo')],
  ['?', t('Show this help')],
];

const CARVING: readonly [string, string][] = [
  [t('Drag, or one finger'), t('Carve')],
  [t('Right drag, Space + drag, or two fingers'), t('Rotate')],
  [t('Middle drag, or three fingers'), t('Pan')],
  ['Shift · Alt', t('Straight line · flat plane')],
  [t('Ctrl + wheel, or pen pressure'), t('Depth')],
  ['[ · ]', t('Size of the tool')],
  ['{ · }', t('Tool')],
  ['P · L', t('Follow the surface or a plane; lean on or off')],
  [t('Ctrl + Z, or tap with two fingers'), t('Undo your last stroke')],
  [t('Ctrl + Shift + Z, or tap with three fingers'), t('Redo')],
  ['Esc', t('End the stroke; press again to stop carving')],
];

const POINTERS: readonly [string, string][] = [
  [t('Drag, or one finger'), t('Rotate')],
  [t('Right drag, or two fingers'), t('Pan')],
  [t('Wheel, or pinch'), t('Zoom toward the pointer')],
  [t('Double-click'), t('Center the view there')],
];

function Table({ rows }: { rows: readonly [string, string][] }) {
  return (
    <dl class="keys">
      {rows.map(([key, meaning]) => (
        <Fragment key={key}>
          <dt>{key}</dt>
          <dd>{meaning}</dd>
        </Fragment>
      ))}
    </dl>
  );
}

/** Opens the help. */
export function helpAction(isOpen: Signal<boolean>): ButtonAction {
  return {
    ...{ name: 'help', label: t('Keyboard and mouse'), key: '?', icon: ICONS.help },
    class: 'help-button',
    perform: () => (isOpen.value = true),
  };
}

export function Help({ isOpen }: { isOpen: Signal<boolean> }) {
  return (
    <Dialog class="help" label={t('Keyboard and mouse')} isOpen={isOpen} closesOutside>
      {/* Else the button at the end has the focus, and the beginning is out of sight. */}
      <h2 tabIndex={-1} autofocus>
        {t('Keyboard')}
      </h2>
      <Table rows={KEYS} />
      <h2>{t('Mouse, pen and touch')}</h2>
      <Table rows={POINTERS} />
      <h2>{t('While you carve')}</h2>
      <Table rows={CARVING} />
      <form method="dialog" class="help-end">
        {!KERF_IS_SINGLE && (
          <a href="manual/index.html" target="_blank">
            {t('Open the manual')}
          </a>
        )}
        <button class="button">{t('Close')}</button>
      </form>
    </Dialog>
  );
}
