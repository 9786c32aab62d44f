// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Aim, tipOn } from '../../src/carve/aim';
import type { AimSettings, Probed } from '../../src/carve/aim';
import type { Ray } from '../../src/carve/surface';
import type { Hit } from '../../src/model/surface';
import { across, dot, minus, unitOf } from '../../src/model/vector';
import { angleBetween } from '../../src/carve/tool/vectors';
import { toolProfile } from '../../src/model/tool_profile';
import type { ToolInfo, Vec3 } from '../../src/wire/types';

const BOX = { min: [-50, -50, -30] as Vec3, max: [50, 50, 40] as Vec3 };
const BALL: ToolInfo = { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 };
const FLAT: ToolInfo = { id: 2, shape: 'flat', diameter_mm: 4, length_mm: 30 };
const WIDE: ToolInfo = {
  id: 3,
  shape: 'ball',
  diameter_mm: 2,
  length_mm: 6,
  shank: { diameter_mm: 12, length_mm: 20 },
};
const TOOLS = [BALL, FLAT, { ...FLAT, shape: 'bull_nose', corner_radius_mm: 1 }, WIDE];

/** A plane through the origin. */
function slope(normal: Vec3): Probed {
  return {
    hit: ({ origin, direction }) => {
      const at = -dot(origin, normal) / dot(direction, normal);
      const point = [0, 1, 2].map((i) => origin[i]! + at * direction[i]!) as Vec3;
      return { at, point, normal, enters: true };
    },
    smoothNormal: (hit) => hit.normal,
  };
}

/** A ball of 40 mm about the origin, and nothing else. */
const globe: Probed = {
  hit: ({ origin, direction }) => {
    const along = dot(origin, direction);
    const root = along * along - dot(origin, origin) + 1600;
    if (root < 0) return null;
    const at = -along - Math.sqrt(root);
    const point = [0, 1, 2].map((i) => origin[i]! + at * direction[i]!) as Vec3;
    return { at, point, normal: unitOf(point), enters: true };
  },
  smoothNormal: (hit) => hit.normal,
};

function down(x: number, y: number): Ray {
  return { origin: [x, y, 100], direction: [0, 0, -1] };
}

function tilted(degrees: number): Vec3 {
  const angle = (degrees * Math.PI) / 180;
  return [Math.sin(angle), 0, Math.cos(angle)];
}

function aimOf(tool: ToolInfo, settings: Partial<AimSettings> = {}): Aim {
  return new Aim(toolProfile(tool), BOX, {
    mode: 'surface',
    depthMm: 1.5,
    axis: 'vertical',
    ...settings,
  });
}

/** The lowest point against a normal of an outline that is turned about an axis, by brute force. */
function lowest(
  pieces: readonly [number, number][][],
  tip: Vec3,
  axis: Vec3,
  normal: Vec3,
): number {
  const [right, front] = across(axis);
  let least = Infinity;
  for (const [r, z] of pieces.flat()) {
    for (let n = 0; n < 720; ++n) {
      const [c, s] = [r * Math.cos((n * Math.PI) / 360), r * Math.sin((n * Math.PI) / 360)];
      const at = [0, 1, 2].map((i) => tip[i]! + z * axis[i]! + c * right[i]! + s * front[i]!);
      least = Math.min(least, dot(at as Vec3, normal));
    }
  }
  return least;
}

describe('aim', () => {
  it('puts the tip of a vertical tool below the pointer, by the depth', () => {
    for (const tool of TOOLS) {
      const pose = aimOf(tool).hover(slope([0, 0, 1]), down(3, 4));
      expect(pose).toEqual({ tip: [3, 4, -1.5], axis: [0, 0, 1] });
    }
  });

  it.each([10, 35, 60, 85])('cuts as deep on a slope of %d° as on a level', (degrees) => {
    const normal = tilted(degrees);
    for (const tool of TOOLS.slice(0, 3)) {
      const profile = toolProfile(tool);
      const pose = aimOf(tool).hover(slope(normal), down(0, 0))!;
      expect(lowest(profile.pieces, pose.tip, pose.axis, normal)).toBeCloseTo(-1.5, 2);
    }
  });

  it('keeps the shank above the surface', () => {
    const profile = toolProfile(WIDE);
    for (const degrees of [10, 45, 70, 88]) {
      const normal = tilted(degrees);
      const tip = tipOn([0, 0, 0], normal, [0, 0, 1], 1.5, profile)!;
      const shank = lowest(profile.body.pieces, tip, [0, 0, 1], normal);
      const cutter = lowest(profile.pieces, tip, [0, 0, 1], normal);
      expect(shank).toBeGreaterThan(-1e-3);
      expect(cutter).toBeGreaterThan(-1.5 - 1e-3);
      expect(Math.min(Math.abs(shank), Math.abs(cutter + 1.5))).toBeLessThan(1e-2);
    }
  });

  it('does not reach a surface that faces away', () => {
    expect(aimOf(BALL).hover(slope(tilted(91)), down(0, 0))).toBeNull();
    const leaning = aimOf(BALL, { axis: 'surface' });
    expect(leaning.hover(slope(tilted(91)), down(0, 0))).not.toBeNull();
  });

  it('stands across a surface at any angle, also below the equator', () => {
    const aim = aimOf(BALL, { axis: 'surface' });
    for (const degrees of [0, 30, 90, 135, 180]) {
      const normal = tilted(degrees);
      const { tip, axis } = aim.hover(slope(normal), down(0, 0))!;
      expect(angleBetween(axis, normal)).toBeCloseTo(0);
      expect(dot(tip, normal)).toBeCloseTo(-1.5);
    }
  });

  it('leans as a pen does, with its shank clear, and else with the surface', () => {
    const profile = toolProfile(WIDE);
    const aim = aimOf(WIDE, { axis: 'pen' });
    for (const degrees of [-55, -30, 0, 30, 55])
      for (const surface of [-30, 0, 30]) {
        const normal = tilted(surface);
        const { tip, axis } = aim.hover(slope(normal), { ...down(0, 0), pen: tilted(degrees) })!;
        expect(angleBetween(axis, tilted(degrees))).toBeCloseTo(0);
        expect(lowest(profile.body.pieces, tip, axis, normal)).toBeGreaterThan(-1e-3);
      }
    const away = aim.hover(slope(tilted(80)), { ...down(0, 0), pen: tilted(-40) })!;
    expect(angleBetween(away.axis, tilted(80))).toBeCloseTo(0);
    for (const axis of ['vertical', 'surface'] as const) {
      const pose = aimOf(WIDE, { axis }).hover(slope([0, 0, 1]), {
        ...down(0, 0),
        pen: tilted(30),
      })!;
      expect(pose.axis).toEqual([0, 0, 1]);
    }
  });

  it('leans its side away from a wall', () => {
    // A floor and a wall over it at x = 2, which the upright tool of radius 3 would cut.
    const corner: Probed = {
      hit: ({ origin, direction }, reach = Infinity) => {
        const floor = { at: -origin[2] / direction[2], normal: [0, 0, 1] as Vec3 };
        const wall = { at: (2 - origin[0]) / direction[0], normal: [-1, 0, 0] as Vec3 };
        const met = [floor, wall]
          .filter(({ at, normal }) => at > 0 && at < reach && dot(normal, direction) < 0)
          .sort((a, b) => a.at - b.at)[0];
        if (!met) return null;
        const point = [0, 1, 2].map((i) => origin[i]! + met.at * direction[i]!) as Vec3;
        return { ...met, point, enters: true };
      },
      smoothNormal: (hit) => hit.normal,
    };
    // A wall of a half space hides nothing from above: the upper side of the tool is in it.
    const roof: Probed = {
      ...corner,
      hit: (ray, reach) => {
        const { origin, direction } = ray;
        const top = { at: (20 - origin[2]) / direction[2], normal: [0, 0, 1] as Vec3 };
        const point = [0, 1, 2].map((i) => origin[i]! + top.at * direction[i]!) as Vec3;
        const isOn = top.at > 0 && top.at < (reach ?? Infinity) && point[0] > 2;
        return isOn ? { ...top, point, enters: true } : corner.hit(ray, reach);
      },
    };
    const aim = aimOf(BALL, { axis: 'surface' });
    const pose = aim.hover(roof, down(0, 0))!;
    expect(pose.axis[0]).toBeLessThan(-0.1);
    expect(dot(pose.axis, pose.axis)).toBeCloseTo(1);
    expect(aim.touches).toBe(false);
    const far = aim.hover(roof, down(-20, 0))!;
    expect(far.axis).toEqual([0, 0, 1]);
  });

  it('follows a surface at its depth', () => {
    const aim = aimOf(BALL, { axis: 'surface' });
    aim.begin(globe, down(0, 0));
    for (let x = 0; x <= 25; x += 0.5) {
      const { tip, axis } = aim.move(globe, down(x, 0))!;
      const center = [0, 1, 2].map((i) => tip[i]! + 3 * axis[i]!) as Vec3;
      // The smoothed normal is a little behind; the depth is below the plane of that normal.
      expect(Math.hypot(...center)).toBeGreaterThan(41.4);
      expect(Math.hypot(...center)).toBeLessThan(41.65);
    }
  });

  it('stays on the plane through the start of the stroke', () => {
    const aim = aimOf(BALL, { mode: 'plane' });
    const start = aim.begin(globe, down(10, 0))!;
    expect(start.tip[2]).toBeCloseTo(Math.sqrt(1500) - 1.5);
    for (const [x, y] of [
      [0, 0],
      [20, 5],
      [45, 30],
    ] as const) {
      const slanted: Ray = { origin: [x, y - 80, 80], direction: unitOf([0, 1, -1]) };
      const { tip, axis } = aim.move(globe, slanted)!;
      expect(tip[2]).toBeCloseTo(start.tip[2]);
      expect(axis).toEqual([0, 0, 1]);
    }
  });

  it('runs level over the edge of the block, but not to the horizon', () => {
    const aim = aimOf(BALL);
    aim.begin(globe, down(38, 0));
    const edge = aim.move(globe, down(39.9, 0))!;
    const beside = aim.move(globe, down(43, 0))!;
    expect(beside.tip[0]).toBeCloseTo(43);
    expect(beside.tip[2]).toBeCloseTo(Math.sqrt(1600 - 39.9 ** 2) - 1.5);
    expect(edge.axis).toEqual(beside.axis);
    expect(aim.move(globe, down(90, 0))).toBeNull();
    const flatRay: Ray = { origin: [0, -200, 30], direction: unitOf([0.6, 1, 0.01]) };
    expect(aim.move(globe, flatRay)).toBeNull();
  });

  it('looks ahead without going there', () => {
    const [one, other] = [aimOf(BALL, { axis: 'surface' }), aimOf(BALL, { axis: 'surface' })];
    one.begin(globe, down(0, 0));
    other.begin(globe, down(0, 0));
    for (let x = 1; x < 30; ++x) {
      const expected = other.move(globe, down(x, 0));
      expect(one.peek(globe, down(x + 5, 3))).not.toEqual(expected);
      expect(one.peek(globe, down(x, 0))).toEqual(expected);
      expect(one.move(globe, down(x, 0))).toEqual(expected);
    }
    expect(one.peek(globe, down(90, 0))).toBeNull();
  });

  it('begins no stroke off the block', () => {
    const aim = aimOf(BALL);
    expect(aim.begin(globe, down(60, 0))).toBeNull();
    expect(aim.move(globe, down(0, 0))).toBeNull();
  });

  it('turns slowly where the surface has an edge', () => {
    const roof: Probed = {
      hit: (ray): Hit => {
        const x = ray.origin[0];
        const normal = x < 0 ? tilted(-40) : tilted(40);
        const z = -Math.abs(x) * Math.tan((40 * Math.PI) / 180);
        return { at: 100 - z, point: [x, 0, z], normal, enters: true };
      },
      smoothNormal: (hit) => hit.normal,
    };
    const aim = aimOf(BALL, { axis: 'surface' });
    let before = aim.begin(roof, down(-6, 0))!;
    for (let x = -5.9; x < 6; x += 0.1) {
      const pose = aim.move(roof, down(x, 0))!;
      expect(angleBetween(before.axis, pose.axis)).toBeLessThan(0.12);
      expect(Math.hypot(...minus(before.tip, pose.tip))).toBeLessThan(0.6);
      before = pose;
    }
    expect(angleBetween(before.axis, tilted(40))).toBeLessThan(0.05);
  });

  it.each([0, 45, 60, 75, 90])('waits 1 mm clear of a slope of %d°', (degrees) => {
    const normal = tilted(degrees);
    const ray: Ray = { origin: [50, 0, 50], direction: unitOf([-1, 0, -1]) };
    for (const mode of ['surface', 'plane'] as const)
      for (const tool of TOOLS)
        for (const axis of ['vertical', 'surface'] as const) {
          const aim = aimOf(tool, { mode, axis });
          const { pieces, body } = toolProfile(tool);
          for (const pose of [aim.hover(slope(normal), ray)!, aim.begin(slope(normal), ray)!]) {
            const { tip, axis } = aim.lifted(pose);
            const least = lowest([...pieces, ...body.pieces], tip, axis, normal);
            expect(least).toBeCloseTo(1, 2);
          }
        }
  });
});
