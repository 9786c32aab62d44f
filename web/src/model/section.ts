// SPDX-License-Identifier: Apache-2.0
// The surface cut by a plane: the outline of the material in it, and its area.

import type { Vec3 } from '../wire/types';
import type { Hit, Piece } from './surface';
import { cornerOf } from './surface';
import { across, dot, minus, plus } from './vector';

/** The points p with dot(normal, p) = offset, mm. Material in front, beyond offset, is cut away. */
export interface Plane {
  /** Of length 1. */
  normal: Vec3;
  offset: number;
}

export interface Section {
  areaMm2: number;
  /** Length of the outline. */
  outlineMm: number;
  /** Lines of the outline, two points each. */
  lines: Float32Array;
}

/** The least and the greatest offset of planes of this normal that meet a box. */
export function offsetsOf(normal: Vec3, min: Vec3, max: Vec3): [least: number, greatest: number] {
  let least = 0;
  let greatest = 0;
  for (const n of [0, 1, 2] as const) {
    least += Math.min(normal[n] * min[n], normal[n] * max[n]);
    greatest += Math.max(normal[n] * min[n], normal[n] * max[n]);
  }
  return [least, greatest];
}

/** Where an edge crosses the plane, from the distances of its ends. */
function crossing(a: Vec3, b: Vec3, da: number, db: number): Vec3 {
  const part = da / (da - db);
  return [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2])];
}

/**
 * The line in which a triangle, counterclockwise seen from outside, crosses the plane: from where
 * its boundary goes down to where it comes up, so that material is on the left seen from in front.
 * A corner in the plane counts as in front, by which each crossing is found once.
 */
function lineOf(corners: Float64Array, at: number, plane: Plane): [Vec3, Vec3] | null {
  const points = [0, 3, 6].map((n) => cornerOf(corners, at + n)) as [Vec3, Vec3, Vec3];
  const heights = points.map((point) => dot(point, plane.normal) - plane.offset);
  let down: Vec3 | null = null;
  let up: Vec3 | null = null;
  for (const n of [0, 1, 2] as const) {
    const next = ((n + 1) % 3) as 0 | 1 | 2;
    const [from, to] = [heights[n]!, heights[next]!];
    if (from >= 0 && to < 0) down = crossing(points[n], points[next], from, to);
    if (from < 0 && to >= 0) up = crossing(points[n], points[next], from, to);
  }
  return down && up ? [down, up] : null;
}

/** Cuts a closed surface. The area is exact for the triangles (Green's theorem over the outline). */
export function sectionOf(pieces: readonly Piece[], plane: Plane): Section {
  const lines: number[] = [];
  const [u, v] = across(plane.normal);
  let origin: [number, number] | null = null;
  let twiceArea = 0;
  let outlineMm = 0;
  for (const { min, max, corners: cornersOf } of pieces) {
    const [least, greatest] = offsetsOf(plane.normal, min, max);
    if (plane.offset < least || plane.offset > greatest) continue;
    const corners = cornersOf();
    for (let at = 0; at < corners.length; at += 9) {
      const line = lineOf(corners, at, plane);
      if (!line) continue;
      const [from, to] = line;
      origin ??= [dot(from, u), dot(from, v)];
      const [ax, ay] = [dot(from, u) - origin[0], dot(from, v) - origin[1]];
      const [bx, by] = [dot(to, u) - origin[0], dot(to, v) - origin[1]];
      twiceArea += ax * by - ay * bx;
      outlineMm += Math.hypot(bx - ax, by - ay);
      lines.push(...from, ...to);
    }
  }
  return { areaMm2: twiceArea / 2, outlineMm, lines: Float32Array.from(lines) };
}

/**
 * The first hit of a line of sight behind the plane: the surface, or the material cut by the plane.
 * Null: nothing.
 */
export function firstBehind(
  hits: readonly Hit[],
  origin: Vec3,
  direction: Vec3,
  plane: Plane | null,
): Hit | null {
  if (!plane) return hits.find(({ at, enters }) => at >= 0 && enters) ?? null;
  const { normal, offset } = plane;
  const isKept = (hit: Hit): boolean => dot(hit.point, normal) <= offset;
  const slope = dot(direction, normal);
  const surface = hits.find((hit) => hit.at >= 0 && hit.enters && isKept(hit)) ?? null;
  if (slope >= 0) return surface;
  const at = (offset - dot(origin, normal)) / slope;
  const behind = hits.filter((hit) => hit.at > at);
  const inside = behind.reduce((sum, { enters }) => sum + (enters ? -1 : 1), 0) > 0;
  return at >= 0 && inside
    ? { at, point: plus(origin, direction, at), normal, enters: true }
    : surface;
}

/** The point of a plane that is nearest to another. */
export function footOf(point: Vec3, { normal, offset }: Plane): Vec3 {
  return minus(point, [0, 1, 2].map((n) => normal[n]! * (dot(point, normal) - offset)) as Vec3);
}
