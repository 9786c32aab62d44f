// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { MOUSE } from 'three';
import type { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { dragOf, navigationOf, NAVIGATIONS } from '../src/model/navigation';
import { MouseButtons } from '../src/view/mouse_buttons';

const NONE = { shiftKey: false, ctrlKey: false };

class Canvas {
  private press_: (event: PointerEvent) => void = () => undefined;
  addEventListener(_: string, press: (event: PointerEvent) => void): void {
    this.press_ = press;
  }
  press(button: number, keys: Partial<typeof NONE> = {}, pointerType = 'mouse'): void {
    this.press_({ button, pointerType, ...NONE, ...keys } as PointerEvent);
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

describe('what the mouse buttons do', () => {
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

  it('is left alone where others have given the buttons another task', () => {
    const { canvas, mouseButtons } = buttonsOf('solidworks');
    mouseButtons.MIDDLE = MOUSE.PAN; // as while one carves
    canvas.press(1, { shiftKey: true });
    expect(mouseButtons.MIDDLE).toBe(MOUSE.PAN);
  });
});
