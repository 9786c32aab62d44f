// SPDX-License-Identifier: Apache-2.0
// Whether two meshes of a tile are the same surface, up to a distance: each one's corners and the
// middles of its triangles lie on the other.

import type { Vec3 } from '../wire/types';

/** Nine numbers for each triangle. */
export type Corners = Float64Array;

const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const less = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cornerAt = (of: Corners, at: number): Vec3 => [of[at]!, of[at + 1]!, of[at + 2]!];

/** The square of the distance from the segment along `edge`, which begins `from` off. */
function squareToEdge(from: Vec3, edge: Vec3): number {
  const length = dot(edge, edge);
  const share = length > 0 ? Math.min(1, Math.max(0, dot(from, edge) / length)) : 0;
  const off = less(from, [edge[0] * share, edge[1] * share, edge[2] * share]);
  return dot(off, off);
}

/** The square of a point's distance from the triangle whose corners begin at `at`. */
export function squareToTriangle(point: Vec3, of: Corners, at: number): number {
  const [a, b, c] = [cornerAt(of, at), cornerAt(of, at + 3), cornerAt(of, at + 6)];
  const [ab, ac, ap] = [less(b, a), less(c, a), less(point, a)];
  const [d11, d12, d22] = [dot(ab, ab), dot(ab, ac), dot(ac, ac)];
  const [p1, p2] = [dot(ap, ab), dot(ap, ac)];
  const area = d11 * d22 - d12 * d12;
  const v = (d22 * p1 - d12 * p2) / area;
  const w = (d11 * p2 - d12 * p1) / area;
  if (v >= 0 && w >= 0 && v + w <= 1) {
    const on: Vec3 = [ab[0] * v + ac[0] * w, ab[1] * v + ac[1] * w, ab[2] * v + ac[2] * w];
    const off = less(ap, on);
    return dot(off, off);
  }
  const bp = less(point, b);
  return Math.min(squareToEdge(ap, ab), squareToEdge(ap, ac), squareToEdge(bp, less(c, b)));
}

/** Corners and middles of all triangles. */
function* pointsOf(of: Corners): Generator<Vec3> {
  for (let at = 0; at < of.length; at += 9) {
    const [a, b, c] = [cornerAt(of, at), cornerAt(of, at + 3), cornerAt(of, at + 6)];
    yield a;
    yield b;
    yield c;
    yield [(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3];
  }
}

/** A point of which others are not farther than `distance` if they have the same key. */
function keyOf(point: Vec3, distance: number): string {
  const cell = distance / 2;
  return point.map((value) => Math.floor(value / cell)).join();
}

function liesOn(points: Corners, surface: Corners, distance: number): boolean {
  const near = new Set<string>();
  for (const point of pointsOf(surface)) near.add(keyOf(point, distance));
  const most = distance * distance;
  for (const point of pointsOf(points)) {
    const key = keyOf(point, distance);
    if (near.has(key)) continue;
    let at = 0;
    while (at < surface.length && !(squareToTriangle(point, surface, at) <= most)) at += 9;
    if (at >= surface.length) return false;
  }
  return true;
}

/** Whether no corner and no middle of a triangle of one is farther than that from the other. */
export function isSameSurface(a: Corners, b: Corners, distance: number): boolean {
  return liesOn(a, b, distance) && liesOn(b, a, distance);
}
