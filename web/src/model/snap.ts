// SPDX-License-Identifier: Apache-2.0
// The corner or edge of the surface that is meant by a point near to it.

import type { Vec3 } from '../wire/types';
import { cornerOf, normalOf } from './surface';
import { distance, dot, minus, plus, unitOf } from './vector';

export interface Snapped {
  kind: 'corner' | 'edge' | 'face';
  point: Vec3;
}

/** Faces that meet at a greater angle have an edge between them. */
const CREASE_COS = Math.cos((25 * Math.PI) / 180);
/** Edges that meet at a greater angle have a corner between them. */
const CORNER_COS = Math.cos((30 * Math.PI) / 180);
/** Vertices of neighboring tiles, whose coordinates are rounded differently, are one. */
const WELD_MM = 0.004;
/** So far out edges cannot be distinguished. */
const TRIANGLES_MAX = 6000;

interface Edge {
  a: number;
  b: number;
  normals: Vec3[];
}

/** Numbers vertices; those within WELD_MM of each other are one. */
class Welder {
  readonly points: Vec3[] = [];
  private readonly cells_ = new Map<string, number[]>();

  add(point: Vec3): number {
    const cell = (by: Vec3): string =>
      point.map((value, n) => Math.round((value + by[n]!) / (4 * WELD_MM))).join();
    for (let n = 0; n < 8; n += 1) {
      const by: Vec3 = [n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1];
      const near = this.cells_.get(cell(by.map((sign) => sign * WELD_MM) as Vec3)) ?? [];
      const found = near.find((vertex) => distance(this.points[vertex]!, point) <= WELD_MM);
      if (found !== undefined) return found;
    }
    this.points.push(point);
    const key = cell([0, 0, 0]);
    this.cells_.set(key, [...(this.cells_.get(key) ?? []), this.points.length - 1]);
    return this.points.length - 1;
  }
}

function creasesOf(triangles: Float64Array, welder: Welder): Edge[] {
  const edges = new Map<string, Edge>();
  for (let at = 0; at < triangles.length; at += 9) {
    const normal = normalOf(triangles, at);
    const [a, b, c] = [0, 3, 6].map((n) => welder.add(cornerOf(triangles, at + n))) as Vec3;
    if (a === b || b === c || c === a) continue;
    for (const [from, to] of [
      [a, b],
      [b, c],
      [c, a],
    ] as const) {
      const [low, high] = from < to ? [from, to] : [to, from];
      const key = `${low},${high}`;
      const edge = edges.get(key) ?? { a: low, b: high, normals: [] };
      edge.normals.push(normal);
      edges.set(key, edge);
    }
  }
  return [...edges.values()].filter(
    ({ normals }) => normals.length === 2 && dot(normals[0]!, normals[1]!) < CREASE_COS,
  );
}

/** The point of a line from `a` to `b` that is nearest to another. */
export function nearestOn(point: Vec3, a: Vec3, b: Vec3): Vec3 {
  const arm = minus(b, a);
  const length2 = dot(arm, arm);
  const part = length2 === 0 ? 0 : dot(minus(point, a), arm) / length2;
  return plus(a, arm, Math.min(1, Math.max(0, part)));
}

/** Vertices at which edges end or turn. */
function turnsOf(edges: readonly Edge[], points: readonly Vec3[]): Vec3[] {
  const arms = new Map<number, Vec3[]>();
  for (const { a, b } of edges) {
    const arm = unitOf(minus(points[b]!, points[a]!));
    arms.set(a, [...(arms.get(a) ?? []), arm]);
    arms.set(b, [...(arms.get(b) ?? []), [-arm[0], -arm[1], -arm[2]]]);
  }
  return [...arms]
    .filter(([, [one, other, ...more]]) => {
      if (more.length > 0) return true;
      return one !== undefined && other !== undefined && -dot(one, other) < CORNER_COS;
    })
    .map(([vertex]) => points[vertex]!);
}

function nearest(point: Vec3, all: readonly Vec3[], radius: number): Vec3 | null {
  let best: Vec3 | null = null;
  let least = radius;
  for (const other of all) {
    const apart = distance(point, other);
    if (apart > least) continue;
    least = apart;
    best = other;
  }
  return best;
}

/**
 * Moves a point of the surface to a corner within `radius`, else to an edge within it, else leaves it.
 * @param triangles around the point, see trianglesNear()
 * @param lines further edges, two points each, such as the outline of a section
 */
export function snapTo(
  point: Vec3,
  triangles: Float64Array,
  radius: number,
  lines: ArrayLike<number> = [],
): Snapped {
  const outline: Vec3[] = [];
  for (let at = 0; at < lines.length; at += 6) {
    const [a, b] = [0, 3].map(
      (n) => [lines[at + n], lines[at + n + 1], lines[at + n + 2]] as Vec3,
    ) as [Vec3, Vec3];
    outline.push(nearestOn(point, a, b));
  }
  const welder = new Welder();
  const creases = triangles.length > 9 * TRIANGLES_MAX ? [] : creasesOf(triangles, welder);
  const { points } = welder;
  const corner = nearest(point, turnsOf(creases, points), radius);
  if (corner) return { kind: 'corner', point: corner };
  const onEdges = creases.map(({ a, b }) => nearestOn(point, points[a]!, points[b]!));
  const edge = nearest(point, [...onEdges, ...outline], radius);
  return edge ? { kind: 'edge', point: edge } : { kind: 'face', point };
}
