// SPDX-License-Identifier: Apache-2.0
// Divides triangles so that a value that varies along a face can be shown at their corners.

import { distance } from './vector';
import type { Vec3 } from '../wire/types';

/** Triangles with shared corners. */
export interface Triangles {
  /** Three numbers a corner. */
  positions: Float32Array<ArrayBuffer>;
  normals: Float32Array<ArrayBuffer>;
  /** Three numbers a triangle. */
  index: Uint32Array<ArrayBuffer>;
}

/** Of the block's diagonal. */
const EDGE_SHARE = 1 / 160;

/** The longest edge, mm, along which the paint on a block does not change. */
export function paintedEdge(pitchMm: number, { min, max }: { min: Vec3; max: Vec3 }): number {
  return Math.max(2 * pitchMm, EDGE_SHARE * distance(min, max));
}

/** So small an edge is not divided, whatever the limit: bounds the work. */
const HALVINGS_MAX = 8;

/** Grows as corners are added. */
class Corners {
  readonly positions: number[];
  readonly normals: number[];
  private readonly middles_ = new Map<number, number>();

  constructor({ positions, normals }: Triangles) {
    this.positions = [...positions];
    this.normals = [...normals];
  }

  lengthOf(a: number, b: number): number {
    const { positions: p } = this;
    return Math.hypot(
      p[3 * a]! - p[3 * b]!,
      p[3 * a + 1]! - p[3 * b + 1]!,
      p[3 * a + 2]! - p[3 * b + 2]!,
    );
  }

  /** The corner in the middle of an edge; triangles on both sides of it get the same. */
  middle(a: number, b: number): number {
    const key = Math.min(a, b) * 2 ** 26 + Math.max(a, b);
    const known = this.middles_.get(key);
    if (known !== undefined) return known;
    const at = this.positions.length / 3;
    for (const values of [this.positions, this.normals])
      for (let n = 0; n < 3; n += 1) values.push((values[3 * a + n]! + values[3 * b + n]!) / 2);
    this.middles_.set(key, at);
    return at;
  }
}

/**
 * Divides edges longer than `limit` in their middles until none is, eight times at most. Whether an
 * edge is divided depends on the edge alone, so neighbors have the same corners on it.
 */
export function refined(triangles: Triangles, limit: number): Triangles {
  const corners = new Corners(triangles);
  let index: number[] = [...triangles.index];
  for (let turn = 0; turn < HALVINGS_MAX; turn += 1) {
    const next: number[] = [];
    for (let n = 0; n < index.length; n += 3) divide(corners, index, n, limit, next);
    if (next.length === index.length) break;
    index = next;
  }
  return {
    positions: Float32Array.from(corners.positions),
    normals: Float32Array.from(corners.normals),
    index: Uint32Array.from(index),
  };
}

/** Adds the parts of the triangle at `n`, of which the edges that are too long were divided. */
function divide(
  corners: Corners,
  index: readonly number[],
  n: number,
  limit: number,
  parts: number[],
): void {
  const [a, b, c] = [index[n]!, index[n + 1]!, index[n + 2]!];
  const cut = (from: number, to: number): number | null =>
    corners.lengthOf(from, to) > limit ? corners.middle(from, to) : null;
  const [ab, bc, ca] = [cut(a, b), cut(b, c), cut(c, a)];
  if (ab !== null && bc !== null && ca !== null)
    parts.push(a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca);
  else if (ab === null && bc === null && ca === null) parts.push(a, b, c);
  else fan(corners, [a, b, c], [ab, bc, ca], parts);
}

/** Of a triangle with one or two divided edges. */
function fan(
  corners: Corners,
  [a, b, c]: [number, number, number],
  [ab, bc, ca]: [number | null, number | null, number | null],
  parts: number[],
): void {
  // Turned until the first edge is divided, and the last one is not.
  if (ab === null || ca !== null) {
    fan(corners, [b, c, a], [bc, ca, ab], parts);
    return;
  }
  if (bc === null) {
    parts.push(a, ab, c, ab, b, c);
    return;
  }
  parts.push(ab, b, bc);
  // The shorter diagonal of the rest.
  if (corners.lengthOf(a, bc) < corners.lengthOf(ab, c)) parts.push(a, ab, bc, a, bc, c);
  else parts.push(a, ab, c, ab, bc, c);
}
