// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import {
  newTool,
  pointsOf,
  snapped,
  withoutPoint,
  withPoint,
  withPointBefore,
  withPoints,
} from '../src/model/profile_draft';
import type { ProfilePoint } from '../src/model/profile_draft';
import { toolProfile } from '../src/model/tool_profile';
import type { ToolInfo } from '../src/wire/types';

const SHAPES: ToolInfo[] = [
  { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 },
  { id: 2, shape: 'flat', diameter_mm: 4, length_mm: 20 },
  { id: 3, shape: 'bull_nose', diameter_mm: 12, corner_radius_mm: 3, length_mm: 35 },
  { id: 4, shape: 'cone_end', diameter_mm: 6, tip_angle_deg: 60, length_mm: 30 },
  { id: 5, shape: 'profile', profile_mm: [[0, 0], { to: [3, 9], center: [0, 5] }, [3, 30]] },
  { id: 6, shape: 'profile', profile_mm: [[2, 0], { to: [6, 4], radius: 5, bulge: 'in' }, [6, 9]] },
  { id: 7, shape: 'profile', profile_mm: [[2, 0], { to: [6, 4], center: [2, 4] }, [6, 9]] },
  { id: 8, shape: 'profile', profile_mm: [[2, 0], { to: [6, 4], center: [6, 0] }, [6, 9]] },
];

/** Greatest distance of the corners of an outline from another, both as drawn. */
function apart(one: ToolInfo, other: ToolInfo): number {
  const [a, b] = [one, other].map((tool) => toolProfile(tool).pieces.flat());
  return Math.max(
    ...a!.map(([r, z]) => Math.min(...b!.map((to) => Math.hypot(r - to[0], z - to[1])))),
  );
}

describe('the outline of a tool', () => {
  it.each(SHAPES)('is that of the tool before it is edited: $shape $id', (tool) => {
    const drawn = withPoints(tool, pointsOf(tool)!);
    expect(drawn.shape).toBe('profile');
    expect(drawn.id).toBe(tool.id);
    expect(apart(tool, drawn)).toBeLessThan(1e-6);
    expect(apart(drawn, tool)).toBeLessThan(1e-6);
  });

  it('cannot be edited where its arcs are at odd places', () => {
    const taper = { id: 1, shape: 'taper', diameter_mm: 6, length_mm: 30, tip: 'ball' } as const;
    expect(pointsOf(taper)).toBeNull();
    expect(pointsOf({ id: 1, shape: 'apt', d_mm: 10 })).toBeNull();
  });

  it('keeps shank and holder', () => {
    const shank = { diameter_mm: 6, length_mm: 20 };
    const holder = [{ diameter_mm: 20, length_mm: 8 }];
    const tool = { ...SHAPES[0]!, shank, holder };
    expect(withPoints(tool, pointsOf(tool)!)).toMatchObject({ shank, holder });
  });
});

describe('a point', () => {
  const ball = pointsOf(SHAPES[0]!)!; // (0, 0), arc to (3, 3), (3, 30)

  it('moves alone, and its arcs stay as round as they must be', () => {
    const moved = withPoint(ball, 1, { r: 8, z: 6 });
    expect(moved[0]).toEqual(ball[0]);
    expect(moved[2]).toEqual(ball[2]);
    expect(moved[1]).toMatchObject({ r: 8, z: 6, edge: 'out' });
    expect(moved[1]!.radius).toBeGreaterThanOrEqual(5);
    expect(moved[1]!.radius).toBeLessThan(5.01);
  });

  it('gives the arc behind it its least radius too', () => {
    const start = withPoint(ball, 0, { r: 0, z: 0 });
    const far = withPoint([{ ...start[0]!, r: -9 }, ...start.slice(1)], 0, { r: -7 });
    expect(far[1]!.radius).toBeGreaterThan(5);
  });

  it('has a radius where an arc leads to it, none where a line does', () => {
    const arc = withPoint(ball, 2, { edge: 'in' });
    expect(arc[2]).toMatchObject({ edge: 'in' });
    expect(arc[2]!.radius).toBeGreaterThanOrEqual(13.5);
    expect(withPoint(arc, 2, { edge: 'line' })[2]!.radius).toBe(0);
  });

  it('is added in the middle of a line or arc, which is straight then', () => {
    const more = withPointBefore(ball, 2);
    expect(more.map(({ r, z }) => [r, z])).toEqual([
      [0, 0],
      [3, 3],
      [3, 16.5],
      [3, 30],
    ]);
    expect(withPointBefore(ball, 1)[2]).toMatchObject({ edge: 'line', radius: 0 });
  });

  it('is removed; the first one is reached by nothing', () => {
    const rest: ProfilePoint[] = withoutPoint(ball, 0);
    expect(rest.map(({ edge }) => edge)).toEqual(['line', 'line']);
    expect(withoutPoint(ball, 1).map(({ r, z }) => [r, z])).toEqual([
      [0, 0],
      [3, 30],
    ]);
  });

  it('is dragged in tenths of a millimeter', () => {
    expect(snapped(1.2345)).toBe(1.2);
    expect(snapped(0.3 + 0.04)).toBe(0.3);
  });
});

it('a tool that is added has an id of its own', () => {
  expect(newTool(SHAPES).id).toBe(9);
  expect(newTool([]).id).toBe(1);
});
