// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h } from 'preact';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { cameraStep } from '../src/model/cap_push';
import { CapMouse, CapMouseChoice, CapMouseSettings } from '../src/carve/devices/cap_mouse';
import { fakeMouse } from './support/fake_space_mouse';
import type { FakeMouse } from './support/fake_space_mouse';
import { enter, press, show } from './support/shown';
import { turn } from './support/turn';

const REST = { move: [0, 0, 0], lean: [0, 0], twist: 0 } as const;

describe('a pushed cap', () => {
  const push = (part: object): Parameters<typeof cameraStep>[0] => ({
    ...REST,
    move: [0, 0, 0],
    ...part,
  });

  it('takes the block along: the camera moves in the opposite direction', () => {
    expect(cameraStep(push({ move: [1, 0.5, 0] }), 'block', 0.02)).toEqual({
      aroundRad: 0,
      upRad: 0,
      panRight: -0.02,
      panUp: -0.01,
      zoom: 1,
    });
    const near = cameraStep(push({ move: [0, 0, 1] }), 'block', 0.02)!;
    expect(near.zoom).toBeCloseTo(Math.exp(-0.03), 12);
    // Its top towards the viewer shows more of the top; clockwise it turns so.
    const turn = cameraStep(push({ lean: [0, 1], twist: 1 }), 'block', 0.02)!;
    expect([turn.upRad, turn.aroundRad]).toEqual([0.03, 0.03]);
  });

  it('flies the camera in the other sense', () => {
    const all = push({ move: [1, 1, 1], lean: [0, 1], twist: 1 });
    const [block, camera] = [cameraStep(all, 'block', 0.01)!, cameraStep(all, 'camera', 0.01)!];
    expect(camera.panRight).toBe(-block.panRight);
    expect(camera.panUp).toBe(-block.panUp);
    expect(camera.upRad).toBe(-block.upRad);
    expect(camera.aroundRad).toBe(-block.aroundRad);
    expect(camera.zoom).toBeCloseTo(1 / block.zoom, 12);
  });

  it('does nothing at rest and aside, and does not jump after a page stood still', () => {
    expect(cameraStep(push({}), 'block', 0.02)).toBeNull();
    expect(cameraStep(push({ lean: [1, 0] }), 'block', 0.02)).toBeNull();
    expect(cameraStep(push({ twist: 1 }), 'block', 60)!.aroundRad).toBeCloseTo(0.075, 12);
    expect(cameraStep(push({ twist: 1 }), 'block', -1)!.aroundRad).toBe(0);
  });
});

interface Made {
  button: HTMLButtonElement;
  sense: HTMLSelectElement;
}

describe('a 3D mouse for the camera', () => {
  let stored: Map<string, string>;
  let frames: ((nowMs: number) => void)[];
  let moves: string[];
  let said: string[];
  let isBusy: boolean;
  let hasFocus: boolean;

  beforeEach(() => {
    stored = new Map();
    frames = [];
    moves = [];
    said = [];
    isBusy = false;
    hasFocus = true;
    vi.spyOn(document, 'hasFocus').mockImplementation(() => hasFocus);
    vi.stubGlobal('localStorage', {
      getItem: (key: string) => stored.get(key) ?? null,
      setItem: (key: string, value: string) => stored.set(key, value),
    });
    vi.stubGlobal('requestAnimationFrame', (act: (nowMs: number) => void) => frames.push(act));
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  function make({ hid }: FakeMouse): Made {
    const note =
      (name: string) =>
      (...values: number[]): void => {
        if (values.some((value) => value !== (name === 'zoom' ? 1 : 0)))
          moves.push(`${name} ${values.map((value) => (value + 0).toFixed(3)).join(' ')}`);
      };
    const rig = { orbit: note('orbit'), pan: note('pan'), zoom: note('zoom'), fit: note('fit') };
    const host = { rig: () => rig, isBusy: () => isBusy, say: (text: string) => said.push(text) };
    const root = show(h(CapMouseSettings, { mouse: new CapMouse(host, hid) }));
    return { button: root.querySelector('button')!, sense: root.querySelector('select')! };
  }
  const pressed = ({ button }: Pick<Made, 'button'>): string | null =>
    button.getAttribute('aria-pressed');
  /** Its code is loaded when it is needed. */
  const opened = (made: Pick<Made, 'button'>): Promise<void> =>
    vi.waitFor(() => expect(pressed(made)).toBe('true'), { timeout: 30_000 });
  /** The next displayed frame. */
  function frame(nowMs: number): void {
    for (const act of frames.splice(0)) act(nowMs);
  }

  it('is chosen by a press, moves the picture, and is turned off by another', async () => {
    const mouse = fakeMouse(false);
    const made = make(mouse);
    expect([pressed(made), made.sense.hidden]).toEqual(['false', true]);
    made.button.click();
    await opened(made);
    expect([made.sense.hidden, stored.get('kerf.space-mouse')]).toEqual([false, 'block']);
    frame(1000);
    // Recorded: the cap of a SpaceMouse pushed to the right, then twisted.
    mouse.report(1, 0x5e, 0x01, 0x00, 0x00, 0x00, 0x00, 0, 0, 0, 0, 0, 0);
    frame(1020);
    mouse.report(1, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0, 0, 0, 0, 0x5e, 0x01);
    frame(1040);
    // Pushed away from the user: the block goes away.
    mouse.report(1, 0x00, 0x00, 0xa2, 0xfe, 0x00, 0x00, 0, 0, 0, 0, 0, 0);
    frame(1060);
    mouse.report(1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    frame(1080);
    expect(moves).toEqual(['pan -0.020 0.000', 'orbit 0.030 0.000', 'zoom 1.030']);
    await press(made.button);
    expect([pressed(made), stored.get('kerf.space-mouse')]).toEqual(['false', 'off']);
    mouse.report(1, 0x5e, 0x01, 0, 0, 0, 0);
    frame(1100);
    frame(1120);
    expect([moves.length, frames.length]).toEqual([3, 0]);
  });

  it('has a dead zone', async () => {
    stored.set('kerf.space-mouse', 'block');
    const mouse = fakeMouse();
    const made = make(mouse);
    await opened(made);
    mouse.report(1, 0x0a, 0x00, 0xf6, 0xff, 0x0a, 0x00); // a cap that does not come back to the middle
    frame(1000);
    expect(moves).toEqual([]);
    mouse.report(1, 0x0b, 0x00, 0, 0, 0, 0);
    frame(1020);
    expect(moves).toHaveLength(1);
  });

  it('flies where that was chosen, also in an earlier visit', async () => {
    stored.set('kerf.space-mouse', 'camera');
    const mouse = fakeMouse();
    const made = make(mouse);
    await opened(made);
    mouse.report(1, 0x5e, 0x01, 0, 0, 0, 0);
    frame(1000);
    expect(moves).toEqual(['pan 0.050 0.000']);
    await enter(made.sense, 'block');
    expect(stored.get('kerf.space-mouse')).toBe('block');
    frame(1020);
    expect(moves[1]).toBe('pan -0.020 0.000');
  });

  it('leaves the camera alone while a tool is in hand, or another window has the focus', async () => {
    stored.set('kerf.space-mouse', 'block');
    const mouse = fakeMouse();
    const made = make(mouse);
    await opened(made);
    mouse.report(1, 0x5e, 0x01, 0, 0, 0, 0);
    mouse.report(3, 0x02);
    isBusy = true;
    frame(1000);
    isBusy = false;
    hasFocus = false;
    frame(1020);
    expect(moves).toEqual([]);
    hasFocus = true;
    frame(1040);
    expect(moves).toEqual(['pan -0.020 0.000']);
  });

  it('shows the whole block by its right button', async () => {
    stored.set('kerf.space-mouse', 'block');
    const mouse = fakeMouse();
    const made = make(mouse);
    await opened(made);
    mouse.report(3, 0x02);
    frame(1000);
    frame(1020);
    expect(moves).toEqual(['fit 1000.000']);
  });

  it('is not turned on where none is chosen, and says why one did not open', async () => {
    const none = make(fakeMouse(false, false));
    none.button.click();
    const broken = fakeMouse();
    broken.hid.requestDevice = () => Promise.reject(new Error('denied'));
    make(broken).button.click();
    await vi.waitFor(() => expect(said).toEqual(['The 3D mouse could not be opened: denied']), {
      timeout: 30_000,
    });
    expect([pressed(none), frames.length, stored.size]).toEqual(['false', 0, 0]);
  });

  it('asks again while none is there, and moves the picture once a frame all the same', async () => {
    stored.set('kerf.space-mouse', 'block');
    const mouse = fakeMouse(false);
    const made = make(mouse);
    await vi.waitFor(() => expect(frames).toHaveLength(1), { timeout: 30_000 });
    made.button.click();
    await opened(made);
    expect([frames.length, stored.get('kerf.space-mouse')]).toEqual([1, 'block']);
  });

  it('waits for the picture', async () => {
    stored.set('kerf.space-mouse', 'block');
    const mouse = fakeMouse();
    const host = { rig: () => undefined, isBusy: () => false, say: () => undefined };
    const root = show(h(CapMouseSettings, { mouse: new CapMouse(host, mouse.hid) }));
    await opened({ button: root.querySelector('button')! });
    mouse.report(1, 0x5e, 0x01, 0, 0, 0, 0);
    expect(() => frame(1000)).not.toThrow();
    expect(frames).toHaveLength(1);
  });

  it('stays off where it was turned off, and is shown as off when it is unplugged', async () => {
    stored.set('kerf.space-mouse', 'off');
    make(fakeMouse());
    stored.set('kerf.space-mouse', 'block');
    const mouse = fakeMouse();
    const made = make(mouse);
    await opened(made);
    expect(frames).toHaveLength(1);
    mouse.plug(false);
    frame(1000);
    await turn();
    expect(pressed(made)).toBe('false');
  });

  it('has no settings where the browser can have none', () => {
    vi.stubGlobal('navigator', {});
    const host = { rig: () => undefined, isBusy: () => false, say: () => undefined };
    expect(show(h(CapMouseChoice, { host })).textContent).toBe('');
  });
});
