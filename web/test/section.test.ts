// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { firstBehind, footOf, offsetsOf, sectionOf } from '../src/model/section';
import type { Plane } from '../src/model/section';
import { hitsOf, normalAround, thicknessAt, trianglesNear } from '../src/model/surface';
import { snapTo } from '../src/model/snap';
import { unitOf } from '../src/model/vector';
import type { Vec3 } from '../src/wire/types';
import { boxPiece, drilledBox } from './support/solids';

const MM = 6; // decimals
const BOX = boxPiece([-10, -5, 0], [10, 5, 8]);
/** 40 × 30 × 10 mm with a hole of 6 mm radius along z, of 720 sides. */
const DRILLED = drilledBox(20, 15, 10, 6, 720);
const HOLE_MM2 = Math.PI * 36;

function across(normal: Vec3, offset: number): Plane {
  return { normal: unitOf(normal), offset };
}

describe('sectionOf', () => {
  it('has the area of a box across each axis and along a diagonal', () => {
    expect(sectionOf([BOX], across([1, 0, 0], 3)).areaMm2).toBeCloseTo(80, MM);
    expect(sectionOf([BOX], across([0, -1, 0], 1)).areaMm2).toBeCloseTo(160, MM);
    const half = Math.SQRT1_2;
    // Through the middle of the edges along y: a rectangle of the side 8 √2.
    const diagonal = sectionOf([BOX], { normal: [half, 0, half], offset: 4 * half });
    expect(diagonal.areaMm2).toBeCloseTo(80 * Math.SQRT2, MM);
  });

  it('has the area of a box with a round hole to 0.1 %, whatever the direction', () => {
    const flat = sectionOf(DRILLED, across([0, 0, 1], 4));
    expect(Math.abs(flat.areaMm2 / (1200 - HOLE_MM2) - 1)).toBeLessThan(1e-3);
    expect(Math.abs(flat.outlineMm / (140 + 12 * Math.PI) - 1)).toBeLessThan(1e-3);
    const back = sectionOf(DRILLED, across([0, 0, -1], -4));
    expect(back.areaMm2).toBeCloseTo(flat.areaMm2, MM);
    // Steep: the hole's section is an ellipse.
    const slope = unitOf([0.15, 0.1, 1]);
    const tilted = sectionOf(DRILLED, { normal: slope, offset: 5 * slope[2] });
    expect(Math.abs(tilted.areaMm2 / ((1200 - HOLE_MM2) / slope[2]) - 1)).toBeLessThan(1e-3);
  });

  it('cuts the hole along its axis in two pieces', () => {
    const section = sectionOf(DRILLED, across([0, 1, 0], 3.5));
    const gap = 2 * Math.sqrt(36 - 3.5 ** 2);
    expect(section.areaMm2).toBeCloseTo(10 * (40 - gap), 2);
    expect(section.lines.length % 6).toBe(0);
  });

  it('counts a plane through vertices once, and none outside', () => {
    expect(sectionOf([BOX], across([0, 0, 1], 0)).areaMm2).toBe(0);
    expect(sectionOf([BOX], across([0, 0, 1], 8)).areaMm2).toBeCloseTo(200, MM);
    expect(sectionOf([BOX], across([0, 0, 1], 8.001)).areaMm2).toBe(0);
    // Through the four corners of the hole's polygon that lie on the axes.
    expect(sectionOf(DRILLED, across([0, 1, 0], 0)).areaMm2).toBeCloseTo(280, 2);
  });

  it('is the sum over the pieces of a surface', () => {
    const lower = boxPiece([30, 0, 0], [40, 10, 8]);
    expect(sectionOf([BOX, lower], across([0, 0, 1], 2)).areaMm2).toBeCloseTo(300, MM);
  });
});

describe('lines of sight', () => {
  it('meets the surface in order', () => {
    const hits = hitsOf([BOX], [-50, 1, 2], [1, 0, 0]);
    expect(hits.map(({ at, enters }) => [at, enters])).toEqual([
      [40, true],
      [60, false],
    ]);
    expect(hits[0]!.normal).toEqual([-1, 0, 0]);
  });

  it('counts an edge of two triangles once', () => {
    // Through the diagonals of both sides, and along a line through two corners.
    expect(hitsOf([BOX], [-50, 0, 4], [1, 0, 0])).toHaveLength(2);
    expect(hitsOf([BOX], [-20, -10, -4], unitOf([2, 1, 0.8]))).toHaveLength(2);
  });

  it('sees the material in the cutting plane, and through a hole the surface behind', () => {
    const plane = across([0, 0, 1], 4);
    const down: Vec3 = [0, 0, -1];
    const sight = (x: number, y: number): ReturnType<typeof firstBehind> => {
      const origin: Vec3 = [x, y, 100];
      return firstBehind(hitsOf(DRILLED, origin, down), origin, down, plane);
    };
    expect(sight(12, 9)).toMatchObject({ point: [12, 9, 4], normal: [0, 0, 1] });
    expect(sight(1, 2)).toBeNull();
    const slant = unitOf([0.5, 0, -1]);
    const origin: Vec3 = [5 - 48, 0.01, 100]; // meets the plane in the hole, at x = 5
    const wall = firstBehind(hitsOf(DRILLED, origin, slant), origin, slant, plane);
    expect(wall!.point[0]).toBeCloseTo(6, 3);
    expect(wall!.point[2]).toBeCloseTo(2, 3);
  });

  it('sees the surface from behind the plane, and without a plane', () => {
    const plane = across([0, 0, 1], 4);
    const up: Vec3 = [0, 0, 1];
    const origin: Vec3 = [12, 9, -100];
    const hits = hitsOf(DRILLED, origin, up);
    expect(firstBehind(hits, origin, up, plane)!.point[2]).toBeCloseTo(0, MM);
    expect(firstBehind(hits, origin, up, null)!.point[2]).toBeCloseTo(0, MM);
  });
});

describe('thicknessAt', () => {
  it('is the wall straight through', () => {
    expect(thicknessAt([BOX], [3, 5, 2], [0, 1, 0])).toEqual({ mm: 10, end: [3, -5, 2] });
    const beside = thicknessAt(DRILLED, [20, 0.02, 5], [1, 0, 0]);
    expect(beside!.mm).toBeCloseTo(14, 3); // to the hole
  });

  it('begins at the surface, also from a point that is rounded to the outside of it', () => {
    expect(thicknessAt([BOX], [3, 5.0001, 2], [0, 1, 0])!.end).toEqual([3, -5, 2]);
  });

  it('is nothing from a face that looks inwards', () => {
    expect(thicknessAt([BOX], [3, 5, 2], [0, -1, 0])).toBeNull();
  });
});

describe('snapTo', () => {
  const snapped = (point: Vec3, radius: number): ReturnType<typeof snapTo> =>
    snapTo(point, trianglesNear([BOX], point, radius), radius);

  it('prefers a corner to an edge, and an edge to the face', () => {
    expect(snapped([9.6, 4.7, 8], 0.8)).toEqual({ kind: 'corner', point: [10, 5, 8] });
    expect(snapped([3, 4.7, 8], 0.8)).toEqual({ kind: 'edge', point: [3, 5, 8] });
    expect(snapped([3, 1, 8], 0.8)).toEqual({ kind: 'face', point: [3, 1, 8] });
  });

  it('takes the diagonal of a face for no edge', () => {
    expect(snapped([0, 0, 8], 3).kind).toBe('face');
  });

  it('finds an edge between tiles whose vertices are rounded differently', () => {
    const others = ['-x', '-y', '+y', '-z'];
    const top = boxPiece([-10, -5, 0], [10, 5, 8], [...others, '+x']);
    const side = boxPiece([-10, -5.001, 0], [10.001, 5, 8.001], [...others, '+z']);
    const point: Vec3 = [9.8, 1, 8];
    const near = trianglesNear([top, side], point, 0.5);
    expect(snapTo(point, near, 0.5)).toEqual({ kind: 'edge', point: [10, 1, 8] });
  });

  it('finds the round edge of a hole, which has no corners', () => {
    const point: Vec3 = [6.3, 0, 10];
    const near = trianglesNear(DRILLED, point, 1);
    const edge = snapTo(point, near, 1);
    expect(edge.kind).toBe('edge');
    expect(edge.point[0]).toBeCloseTo(6, 3);
  });

  it('finds the outline of a section', () => {
    const { lines } = sectionOf([BOX], across([0, 0, 1], 4));
    const point: Vec3 = [9.7, 1, 4];
    expect(snapTo(point, new Float64Array(), 0.5, lines)).toEqual({
      kind: 'edge',
      point: [10, 1, 4],
    });
  });
});

describe('planes', () => {
  it('knows which offsets meet a box', () => {
    expect(offsetsOf([0, 0, -1], [-1, -2, -3], [4, 5, 6])).toEqual([-6, 3]);
  });

  it('finds the foot of a point', () => {
    expect(footOf([1, 2, 9], across([0, 0, 1], 4))).toEqual([1, 2, 4]);
  });

  it('takes the mean normal of a face, not of its neighbors', () => {
    const point: Vec3 = [9.5, 4.5, 8];
    expect(normalAround(trianglesNear([BOX], point, 2), [0, 0, 1])).toEqual([0, 0, 1]);
    const tilted = unitOf([0.1, 0, 1]); // as of one rough triangle
    expect(normalAround(trianglesNear([BOX], point, 2), tilted)).toEqual([0, 0, 1]);
  });
});
