// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { MOUSE } from 'three';
import type { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Chord, dragOf, navigationOf, NAVIGATIONS } from '../src/model/navigation';
import { MouseButtons } from '../src/view/mouse_buttons';

const NONE = { shiftKey: false, ctrlKey: false };

/** Passes dispatched events to its listeners, and records them. */
class Canvas {
  readonly sent: string[] = [];
  private readonly acts_: Record<string, (event: PointerEvent) => void> = {};
  addEventListener(type: string, act: (event: PointerEvent) => void): void {
    this.acts_[type] = act;
  }
  press(button: number, keys: Partial<typeof NONE> = {}, pointerType = 'mouse'): void {
    this.acts_['pointerdown']!({ button, pointerType, ...NONE, ...keys } as PointerEvent);
  }
  move(buttons: number): void {
    this.acts_['pointermove']!({ button: -1, buttons, clientX: 7 } as PointerEvent);
  }
  release(): void {
    this.acts_['pointerup']!({ button: 1, buttons: 0 } as PointerEvent);
  }
  dispatchEvent(event: PointerEvent): void {
    this.sent.push(`${event.type} ${event.button} at ${event.clientX}`);
    this.acts_[event.type]!(event);
  }
}

function buttonsOf(id: string): {
  canvas: Canvas;
  mouseButtons: OrbitControls['mouseButtons'];
  buttons: MouseButtons;
} {
  const mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
  const canvas = new Canvas();
  const controls = { mouseButtons } as unknown as OrbitControls;
  const buttons = new MouseButtons(controls, canvas as unknown as HTMLElement);
  buttons.set(navigationOf(id));
  return { canvas, mouseButtons, buttons };
}

describe('the actions of the mouse buttons', () => {
  it('is the default for a name that is unknown', () => {
    expect(navigationOf('maya')).toBe(NAVIGATIONS[0]);
    expect(navigationOf(null)).toBe(NAVIGATIONS[0]);
    expect(new Set(NAVIGATIONS.map(({ id }) => id)).size).toBe(NAVIGATIONS.length);
  });

  it('depends on the key that zooms', () => {
    const blender = navigationOf('blender');
    expect(dragOf(blender, 'middle', NONE)).toBe('rotate');
    expect(dragOf(blender, 'middle', { ...NONE, ctrlKey: true })).toBe('zoom');
    expect(dragOf(blender, 'right', { ...NONE, ctrlKey: true })).toBe('pan');
  });

  it('is given to the controls before each press', () => {
    const { canvas, mouseButtons } = buttonsOf('solidworks');
    expect(mouseButtons).toEqual({ LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.ROTATE, RIGHT: MOUSE.PAN });
    canvas.press(1, { shiftKey: true });
    expect(mouseButtons.MIDDLE).toBe(MOUSE.DOLLY);
    canvas.press(1);
    expect(mouseButtons.MIDDLE).toBe(MOUSE.ROTATE);
    canvas.press(1, { shiftKey: true }, 'pen');
    expect(mouseButtons.MIDDLE).toBe(MOUSE.ROTATE);
  });

  it('changes with the choice, also back', () => {
    const { mouseButtons, buttons } = buttonsOf('onshape');
    expect(mouseButtons).toEqual({ LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.ROTATE });
    buttons.set(navigationOf('kerf'));
    expect(mouseButtons).toEqual({ LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN });
  });

  it('is nothing for the right button of FreeCAD alone, and something with keys', () => {
    const freecad = navigationOf('freecad');
    expect(dragOf(freecad, 'right', NONE)).toBe('none');
    // With a key the controls turn instead of panning, and pan instead of turning.
    expect(dragOf(freecad, 'right', { ...NONE, ctrlKey: true })).toBe('rotate');
    expect(dragOf(freecad, 'right', { ...NONE, shiftKey: true })).toBe('pan');
    expect(dragOf(freecad, 'right', { shiftKey: true, ctrlKey: true })).toBe('zoom');
    expect(dragOf(freecad, 'middle', NONE)).toBe('pan');
    const { canvas, mouseButtons, buttons } = buttonsOf('freecad');
    expect(mouseButtons).toEqual({ LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: null });
    canvas.press(2, { shiftKey: true });
    expect(mouseButtons.RIGHT).toBe(MOUSE.PAN);
    buttons.set(navigationOf('kerf'));
    expect(mouseButtons.RIGHT).toBe(MOUSE.PAN);
  });

  it('is left alone where other code has given the buttons another task', () => {
    const { canvas, mouseButtons } = buttonsOf('solidworks');
    mouseButtons.MIDDLE = MOUSE.PAN; // as while one carves
    canvas.press(1, { shiftKey: true });
    expect(mouseButtons.MIDDLE).toBe(MOUSE.PAN);
  });
});

describe('buttons that are pressed together, as in FreeCAD', () => {
  const [left, right, middle] = [1, 2, 4];

  it('turn while both are held, and pan after that', () => {
    const chord = new Chord();
    chord.begin();
    expect(chord.drag(middle, 0)).toBe('pan');
    expect(chord.drag(middle + left, 100)).toBe('rotate');
    expect(chord.drag(middle + left, 300)).toBe('rotate');
    expect(chord.drag(middle, 500)).toBe('pan');
    expect(chord.drag(middle + right, 600)).toBe('rotate');
    expect(chord.drag(right, 700)).toBeNull();
  });

  it('zoom after a click of the other one, until the middle one is pressed again', () => {
    const chord = new Chord();
    chord.begin();
    chord.drag(middle + right, 100);
    expect(chord.drag(middle, 499)).toBe('zoom');
    expect(chord.drag(middle, 5000)).toBe('zoom');
    expect(chord.drag(middle + left, 5100)).toBe('rotate');
    expect(chord.drag(middle, 5600)).toBe('pan');
    chord.drag(middle + left, 6000);
    chord.drag(middle, 6001);
    chord.begin();
    expect(chord.drag(middle, 7000)).toBe('pan');
  });

  describe('and the controls', () => {
    beforeEach(() => {
      vi.stubGlobal(
        'PointerEvent',
        class {
          constructor(
            readonly type: string,
            init: object,
          ) {
            Object.assign(this, init);
          }
        },
      );
    });
    afterEach(() => vi.unstubAllGlobals());

    it('begin another drag where the buttons change, and end it with the middle one', () => {
      const { canvas, mouseButtons } = buttonsOf('freecad');
      canvas.move(left);
      expect(canvas.sent).toEqual([]); // the left button alone is the controls' own
      canvas.press(1);
      canvas.move(middle);
      expect(canvas.sent).toEqual([]);
      canvas.move(middle + left);
      expect(canvas.sent).toEqual(['pointerup 1 at 7', 'pointerdown 1 at 7']);
      expect(mouseButtons.MIDDLE).toBe(MOUSE.ROTATE);
      canvas.move(left);
      expect(canvas.sent.slice(2)).toEqual(['pointerup 1 at 7']);
      canvas.release();
      canvas.press(1);
      expect(mouseButtons.MIDDLE).toBe(MOUSE.PAN);
      canvas.release();
      canvas.move(middle + left);
      expect(canvas.sent).toHaveLength(3);
    });

    it('pan again after a press that ended with zooming', () => {
      const { canvas, mouseButtons } = buttonsOf('freecad');
      const now = vi.spyOn(performance, 'now').mockReturnValue(1000);
      canvas.press(1);
      canvas.move(middle + left);
      canvas.move(middle);
      now.mockRestore();
      expect(mouseButtons.MIDDLE).toBe(MOUSE.DOLLY);
      canvas.release();
      canvas.press(1);
      canvas.move(middle);
      expect(mouseButtons.MIDDLE).toBe(MOUSE.PAN);
    });

    it('leave the right button alone', () => {
      const { canvas } = buttonsOf('freecad');
      canvas.press(2, { ctrlKey: true });
      canvas.move(right);
      canvas.move(right + left);
      expect(canvas.sent).toEqual([]);
    });

    it('do nothing of the kind in other presets', () => {
      const { canvas, mouseButtons } = buttonsOf('fusion');
      canvas.press(1);
      canvas.move(middle + left);
      expect([canvas.sent, mouseButtons.MIDDLE]).toEqual([[], MOUSE.PAN]);
    });
  });
});
