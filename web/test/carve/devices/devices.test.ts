// SPDX-License-Identifier: Apache-2.0
import { afterEach, describe, expect, it, vi } from 'vitest';
import { Devices } from '../../../src/carve/devices/devices';
import { eased, moved } from '../../../src/carve/devices/deflection';
import { GamepadReader } from '../../../src/carve/devices/gamepad';
import { SpaceMouse } from '../../../src/carve/devices/space_mouse';
import type { Pose } from '../../../src/carve/tool/path_queue';
import type { Wielded } from '../../../src/carve/tool/wielded';
import type { Vec3 } from '../../../src/wire/types';
import { fakeMouse } from '../../support/fake_space_mouse';

const SIDES = { right: [1, 0, 0] as Vec3, towards: [0, -1, 0] as Vec3 };

function pad(axes: number[], held: Record<number, number> = {}, mapping = 'standard'): Gamepad {
  const buttons = Array.from({ length: 17 }, (_, n) => ({ value: held[n] ?? 0 }));
  return { index: 0, mapping, axes, buttons } as unknown as Gamepad;
}

describe('a deflection', () => {
  it('is zero in the middle, fine near it, and whole at the end', () => {
    expect([eased(0.1), eased(-0.1)]).toEqual([0, -0]);
    expect(eased(0.56)).toBeCloseTo(0.25, 9);
    expect([eased(1), eased(-1), eased(1.2)]).toEqual([1, -1, 1]);
  });

  it('moves as the picture lies, and leans the upper end', () => {
    const pose: Pose = { tip: [1, 2, 3], axis: [0, 0, 1] };
    const to = moved(pose, { move: [1, 0.5, 1], lean: [0, 1], press: 0 }, SIDES, 0.1, 100);
    expect(to.tip).toEqual([11, -8, 8]);
    expect(to.axis[1]).toBeCloseTo(-Math.sin(0.12), 9);
    expect(to.axis[2]).toBeCloseTo(Math.cos(0.12), 9);
  });

  it('leans a tool no farther than to where it is pushed', () => {
    let pose: Pose = { tip: [0, 0, 0], axis: [0, 0, 1] };
    const push = { move: [0, 0, 0] as Vec3, lean: [1, 0] as const, press: 0 };
    for (let n = 0; n < 100; n += 1) pose = moved(pose, push, SIDES, 0.05, 1);
    expect(pose.axis[0]).toBeGreaterThan(0.99);
    expect(Math.hypot(...pose.axis)).toBeCloseTo(1, 9);
  });
});

describe('a gamepad', () => {
  it('moves by its left stick, leans by the right one, and presses by the trigger', () => {
    const { move, lean, press } = new GamepadReader().read(pad([1, -1, 0.05, 1], { 7: 0.5, 5: 1 }));
    expect(move).toEqual([1, 1, -1]);
    expect(lean).toEqual([0, 1]);
    expect(press).toBe(0.5);
  });

  it('tells each press of a button once', () => {
    const reader = new GamepadReader();
    const presses = [{}, { 1: 1 }, { 1: 1, 15: 1 }, {}, { 1: 1 }].map(
      (held) => reader.read(pad([0, 0, 0, 0], held)).presses,
    );
    expect(presses).toEqual([[], ['undo'], ['next'], [], ['undo']]);
  });
});

describe('a 3D mouse', () => {
  it('moves and leans by the two reports of the SpaceNavigator', async () => {
    const { hid, report } = fakeMouse();
    const mouse = new SpaceMouse(hid);
    await mouse.open(false);
    report(1, 0x5e, 0x01, 0x00, 0x00, 0xa2, 0xfe); // 350 to the right, 350 up
    expect(mouse.read().move).toEqual([1, 1, 0]);
    report(2, 0x5e, 0x01, 0xa2, 0xfe, 0x00, 0x00); // about right, and against about towards
    expect(mouse.read().lean).toEqual([1, 1]);
    report(2, 0x00, 0x00, 0x00, 0x00, 0x5e, 0x01); // about down: clockwise from above
    expect(mouse.read()).toMatchObject({ lean: [-0, 0], twist: 1 });
    report(1, 0, 0, 0, 0, 0, 0);
    report(2, 0, 0, 0, 0, 0, 0);
    expect(mouse.read().move.every((part) => part === 0)).toBe(true);
  });

  it('has all axes in one report of newer ones', async () => {
    const { hid, report } = fakeMouse();
    const mouse = new SpaceMouse(hid);
    await mouse.open(true);
    report(1, 0, 0, 0x5e, 0x01, 0, 0, 0xa2, 0xfe, 0, 0, 0xa2, 0xfe);
    const { move, lean, twist } = mouse.read();
    expect([move[2], twist]).toEqual([1, -1]);
    expect(lean[1]).toBe(-1);
  });

  it('cuts while the left button is held, and steps once by the right one', async () => {
    const { hid, report } = fakeMouse();
    const mouse = new SpaceMouse(hid);
    await mouse.open(false);
    report(3, 0x03, 0x00);
    expect([mouse.read().press, mouse.read().press]).toEqual([1, 1]);
    report(3, 0x02, 0x00);
    expect(mouse.read()).toMatchObject({ press: 0, presses: [] });
    report(3, 0x00, 0x00);
    report(3, 0x02, 0x00);
    expect(mouse.read().presses).toEqual(['next']);
  });

  it('is not opened twice, and a malformed report moves nothing', async () => {
    const { hid, report } = fakeMouse();
    const mouse = new SpaceMouse(hid);
    await mouse.open(false);
    await mouse.open(true);
    report(1, 0x5e);
    report(3, 0x02);
    expect(mouse.read().presses).toEqual(['next']);
  });
});

describe('a 3D mouse that is unplugged', () => {
  it('rests, and is there again when it is plugged in', async () => {
    const { hid, report, plug } = fakeMouse();
    const mouse = new SpaceMouse(hid);
    await mouse.open(false);
    report(1, 0x5e, 0x01, 0, 0, 0, 0, 0x5e, 0x01, 0, 0, 0x5e, 0x01);
    report(3, 0x01);
    plug(false);
    expect(mouse.isThere).toBe(false);
    expect(mouse.read()).toMatchObject({ move: [0, 0, 0], lean: [-0, 0], twist: 0, press: 0 });
    plug(true);
    await vi.waitFor(() => expect(mouse.isThere).toBe(true));
    report(1, 0x5e, 0x01, 0, 0, 0, 0);
    expect(mouse.read().move[0]).toBe(1);
  });
});

describe('Devices', () => {
  afterEach(() => vi.unstubAllGlobals());

  function wield(reason = ''): { wielded: Wielded; done: string[]; at: () => Pose } {
    const done: string[] = [];
    let pose: Pose | null = null;
    const settings = { tool: null, tools: [], depthMm: 2, chooseTool: vi.fn(), nextTool: vi.fn() };
    const wielded: Wielded = {
      whyNot: () => reason,
      settings,
      moveTo: (to, cuts) => {
        pose = to;
        done.push(cuts ? 'cut' : 'move');
      },
      lift: () => done.push('lift'),
      pose: () => pose,
      undo: () => done.push('undo'),
      redo: () => done.push('redo'),
      forceN: () => 0,
      say: (text) => done.push(text),
    };
    return { wielded, done, at: () => pose! };
  }

  function devicesOf(wielded: Wielded, pads: () => (Gamepad | null)[]): Devices {
    vi.stubGlobal('navigator', { getGamepads: pads });
    const host = {
      wielded,
      sides: () => SIDES,
      start: (): Vec3 => [0, 0, 10],
      diagonalMm: () => 100,
    };
    return new Devices(host, new SpaceMouse());
  }

  it('press the tool down by the trigger, and lift it to where it was', () => {
    const { wielded, done, at } = wield();
    let now = pad([0, 0, 0, 0], { 7: 1 });
    const devices = devicesOf(wielded, () => [null, now]);
    devices.tick(0);
    devices.tick(20);
    expect(at().tip).toEqual([0, 0, 8]);
    now = pad([1, 0, 0, 0], { 7: 1 });
    devices.tick(40);
    expect(at().tip[0]).toBeCloseTo(1, 9); // 50 mm/s
    now = pad([0, 0, 0, 0]);
    devices.tick(60);
    devices.tick(80);
    expect(at().tip[2]).toBe(10);
    expect(done).toEqual(['cut', 'cut', 'cut', 'lift', 'move']);
  });

  it('say why nothing is cut, and leave the tool alone at rest', () => {
    const { wielded, done } = wield('No.');
    let now: Gamepad = pad([0, 0, 0, 0], { 7: 1 });
    const devices = devicesOf(wielded, () => [now]);
    devices.tick(0);
    expect(done).toEqual(['No.', 'lift', 'move']);
    now = pad([0.05, 0, 0, 0]);
    devices.tick(10);
    done.length = 0;
    devices.tick(20);
    expect(done).toEqual([]);
  });

  it('do not move by pads with an unknown layout', () => {
    const { wielded, done } = wield();
    const odd = pad([1, 1, 1, 1], {}, '');
    devicesOf(wielded, () => [odd]).tick(10);
    expect(done).toEqual([]);
  });
});
