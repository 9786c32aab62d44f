// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { listenToKeys, withoutPanels } from '../src/ui/keyboard';
import type { KeyActions } from '../src/ui/keyboard';

const NAMES = [
  ...['preset', 'fit', 'orbit', 'pan', 'zoom', 'followNext', 'followNone', 'toggleArrows'],
  ...['toggleGrid', 'toggleSound', 'toggleTimeline', 'toggleInspect', 'toggleParallel'],
  ...['toggleCarve', 'undo', 'redo', 'help'],
] as const;

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
  let actions: KeyActions;
  let down: (event: unknown) => void;

  beforeEach(() => {
    called = [];
    const noted = NAMES.map((name) => [
      name,
      (...values: unknown[]) => called.push([name, ...values].join(' ')),
    ]);
    actions = Object.fromEntries(noted) as KeyActions;
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

  it('does as the help says', () => {
    listenToKeys(actions);
    for (const key of ['f', 'N', 'Escape', 'a', 'g', 's', 't', 'i', 'o', 'c', '?'])
      expect(press({ key }), key).toBe(true);
    expect(called).toEqual([
      ...['fit', 'followNext', 'followNone', 'toggleArrows', 'toggleGrid', 'toggleSound'],
      ...['toggleTimeline', 'toggleInspect', 'toggleParallel', 'toggleCarve', 'help'],
    ]);
  });

  it('shows a view by its place on the keyboard, and the opposite one with Shift', () => {
    listenToKeys(actions);
    press({ key: '&', code: 'Digit1' }); // a French keyboard
    press({ key: '1', code: 'Digit1', shiftKey: true });
    press({ key: '7', code: 'Numpad7' });
    expect(called).toEqual(['preset front', 'preset back', 'preset top']);
  });

  it('turns the picture by arrows, and moves it with Shift', () => {
    listenToKeys(actions);
    press({ key: 'ArrowLeft' });
    press({ key: 'ArrowUp', shiftKey: true });
    expect(called).toEqual([`orbit ${-Math.PI / 24} 0`, 'pan 0 0.06']);
  });

  it('undoes and redoes with Ctrl or Cmd, and leaves other shortcuts to the browser', () => {
    listenToKeys(actions);
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
    listenToKeys(actions);
    expect(press({ key: 'c' }, true)).toBe(false);
    expect(press({ key: 'z', ctrlKey: true }, true)).toBe(false);
    expect(called).toEqual([]);
  });

  it('changes nothing but the picture in the frame of another site', () => {
    listenToKeys(withoutPanels(actions));
    for (const key of ['c', 't', 'i', '?']) press({ key });
    press({ key: 'z', ctrlKey: true });
    press({ key: 'y', ctrlKey: true });
    expect(called).toEqual([]);
    press({ key: '7', code: 'Digit7' });
    press({ key: 'f' });
    expect(called).toEqual(['preset top', 'fit']);
  });
});
