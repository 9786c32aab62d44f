// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Action } from '../src/ui/actions';
import { listenToKeys } from '../src/ui/keyboard';
import type { CameraKeys } from '../src/ui/keyboard';

const KEYS: readonly [name: string, key: string][] = [
  ['fit', 'F'],
  ['unfollow', 'Escape'],
  ['timeline', 'T'],
  ['help', '?'],
  ['undo', 'Ctrl+Z'],
  ['redo', 'Ctrl+Shift+Z'],
  ['programs', ''],
];

interface Press {
  key: string;
  code?: string;
  shiftKey?: boolean;
  ctrlKey?: boolean;
  metaKey?: boolean;
  altKey?: boolean;
}

describe('a key', () => {
  let called: string[];
  let actions: Action[];
  let camera: CameraKeys;
  let down: (event: unknown) => void;

  beforeEach(() => {
    called = [];
    const note =
      (name: string) =>
      (...values: unknown[]): void =>
        void called.push([name, ...values].join(' '));
    actions = KEYS.map(([name, key]) => ({ name, label: name, key, perform: note(name) }));
    camera = { preset: note('preset'), orbit: note('orbit'), pan: note('pan'), zoom: note('zoom') };
    vi.stubGlobal('window', {
      addEventListener: (_name: string, listener: typeof down) => (down = listener),
    });
  });
  afterEach(() => vi.unstubAllGlobals());

  /** Whether the page has taken the key, so that the browser does nothing with it. */
  function press(event: Press, isInField = false): boolean {
    const preventDefault = vi.fn();
    const target = { closest: () => (isInField ? {} : null) };
    down({ code: '', ...event, target, preventDefault });
    return preventDefault.mock.calls.length > 0;
  }

  it('performs the action that has it, in either case', () => {
    listenToKeys(camera, actions);
    for (const key of ['f', 'F', 'Escape', 't', '?']) expect(press({ key }), key).toBe(true);
    expect(called).toEqual(['fit', 'fit', 'unfollow', 'timeline', 'help']);
  });

  it('belongs to the browser where no action has it', () => {
    listenToKeys(camera, actions);
    for (const key of ['c', 'x', 'Tab', ' ']) expect(press({ key }), key).toBe(false);
    expect(called).toEqual([]);
  });

  it('shows a view by its place on the keyboard, and the opposite one with Shift', () => {
    listenToKeys(camera, actions);
    press({ key: '&', code: 'Digit1' }); // a French keyboard
    press({ key: '1', code: 'Digit1', shiftKey: true });
    press({ key: '7', code: 'Numpad7' });
    expect(called).toEqual(['preset front', 'preset back', 'preset top']);
  });

  it('turns the picture by arrows, and moves it with Shift', () => {
    listenToKeys(camera, actions);
    press({ key: 'ArrowLeft' });
    press({ key: 'ArrowUp', shiftKey: true });
    expect(called).toEqual([`orbit ${-Math.PI / 24} 0`, 'pan 0 0.06']);
  });

  it('undoes and redoes with Ctrl or Cmd, and leaves other shortcuts to the browser', () => {
    listenToKeys(camera, actions);
    press({ key: 'z', ctrlKey: true });
    press({ key: 'Z', metaKey: true, shiftKey: true });
    press({ key: 'y', ctrlKey: true });
    expect(called).toEqual(['undo', 'redo', 'redo']);
    for (const key of ['c', 'f', 't', 's', 'i'])
      expect(press({ key, ctrlKey: true }), key).toBe(false);
    expect(press({ key: 'z', ctrlKey: true, altKey: true })).toBe(false);
    expect(called).toHaveLength(3);
  });

  it('belongs to the field or the dialog in which it is pressed', () => {
    listenToKeys(camera, actions);
    expect(press({ key: 'c' }, true)).toBe(false);
    expect(press({ key: 'z', ctrlKey: true }, true)).toBe(false);
    expect(called).toEqual([]);
  });

  it('zooms, without Ctrl', () => {
    listenToKeys(camera, actions);
    for (const key of ['+', '-']) press({ key });
    expect(press({ key: '+', ctrlKey: true })).toBe(false);
    expect(called).toEqual(['zoom 0.87', `zoom ${1 / 0.87}`]);
  });
});
