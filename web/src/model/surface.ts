// SPDX-License-Identifier: Apache-2.0
// The displayed surface as triangles, and the hits of rays with it. It comes in pieces with boxes,
// of which most need not be looked at.

import type { Vec3 } from '../wire/types';
import { Line } from './line';
import { cross, dot, minus, plus, unitOf } from './vector';

/** A part of the surface. */
export interface Piece {
  min: Vec3;
  max: Vec3;
  /** Nine numbers a triangle, mm; counterclockwise seen from outside. */
  corners: () => Float64Array;
}

/** Where a line meets the surface. */
export interface Hit {
  /** Along the direction, mm. */
  at: number;
  point: Vec3;
  /** Unit vector out of the material. */
  normal: Vec3;
  /** Whether the line enters the material here. */
  enters: boolean;
}

/** Two meetings of a line with an edge that two triangles share. */
const SAME_MM = 1e-7;

export function cornerOf(corners: Float64Array, at: number): Vec3 {
  return [corners[at]!, corners[at + 1]!, corners[at + 2]!];
}

/** The unit normal of the triangle whose corners begin at `at`; zero if it has no area. */
export function normalOf(corners: Float64Array, at: number): Vec3 {
  const a = cornerOf(corners, at);
  const b = cornerOf(corners, at + 3);
  const c = cornerOf(corners, at + 6);
  return unitOf(cross(minus(b, a), minus(c, a)));
}

/** Where a line, in both directions of its origin, meets the surface, in its order. */
export function hitsOf(pieces: readonly Piece[], origin: Vec3, direction: Vec3): Hit[] {
  const line = new Line(origin, direction);
  const hits: Hit[] = [];
  for (const piece of pieces) {
    if (line.enters(piece.min, piece.max, 0, -Infinity) === Infinity) continue;
    const corners = piece.corners();
    for (let n = 0; n < corners.length; n += 9) {
      const at = line.meets(corners, n);
      if (Number.isNaN(at)) continue;
      const normal = normalOf(corners, n);
      const enters = dot(normal, direction) < 0;
      hits.push({ at, point: plus(origin, direction, at), normal, enters });
    }
  }
  hits.sort((a, b) => a.at - b.at);
  return hits.filter(({ at, enters }, n) => {
    const before = hits[n - 1];
    return before?.enters !== enters || at - before.at > SAME_MM;
  });
}

/** The triangles that a ball meets, or nearly, nine numbers each. */
export function trianglesNear(
  pieces: readonly Piece[],
  center: Vec3,
  radius: number,
): Float64Array {
  const near: number[] = [];
  const isFar = (low: number, high: number, n: 0 | 1 | 2): boolean =>
    low > center[n] + radius || high < center[n] - radius;
  for (const { min, max, corners: cornersOf } of pieces) {
    if (([0, 1, 2] as const).some((n) => isFar(min[n], max[n], n))) continue;
    const corners = cornersOf();
    for (let at = 0; at < corners.length; at += 9) {
      const misses = ([0, 1, 2] as const).some((n) => {
        const [a, b, c] = [corners[at + n]!, corners[at + n + 3]!, corners[at + n + 6]!];
        return isFar(Math.min(a, b, c), Math.max(a, b, c), n);
      });
      if (!misses) for (let n = at; n < at + 9; n += 1) near.push(corners[n]!);
    }
  }
  return Float64Array.from(near);
}

/**
 * The mean unit normal, weighed by area, of those triangles around a point of the surface whose
 * normals differ by at most 15 degrees from the one there.
 */
export function normalAround(triangles: Float64Array, normal: Vec3): Vec3 {
  let sum: Vec3 = [0, 0, 0];
  for (let at = 0; at < triangles.length; at += 9) {
    const a = cornerOf(triangles, at);
    const twice = cross(
      minus(cornerOf(triangles, at + 3), a),
      minus(cornerOf(triangles, at + 6), a),
    );
    if (dot(unitOf(twice), normal) > Math.cos(Math.PI / 12)) sum = plus(sum, twice);
  }
  return Math.hypot(...sum) > 0 ? unitOf(sum) : normal;
}

/** The material from a point of the surface straight inwards, mm; null: it has no other side. */
export function thicknessAt(
  pieces: readonly Piece[],
  point: Vec3,
  normal: Vec3,
): { mm: number; end: Vec3 } | null {
  const inwards: Vec3 = [-normal[0], -normal[1], -normal[2]];
  const exit = hitsOf(pieces, point, inwards).find(({ at, enters }) => at > SAME_MM && !enters);
  return exit ? { mm: exit.at, end: exit.point } : null;
}
