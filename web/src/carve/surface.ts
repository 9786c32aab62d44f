// SPDX-License-Identifier: Apache-2.0
// The surface that the page displays, as it was at one moment, for rays from the pointer. A ray is
// tested against the boxes of the tiles first, and against the triangles of those that it meets, from
// the nearest on. Triangles are read when a ray first meets their tile.

import type * as THREE from 'three';
import { stockBounds } from '../model/session';
import type { Bounds } from '../model/session';
import { tileAt } from '../model/tiles';
import type { DisplayedTile } from '../view/tile_view';
import type { Vec3, Welcome } from '../wire/types';
import { plus, scaled, unitOf } from '../model/vector';

export interface Ray {
  origin: Vec3;
  /** Unit length. */
  direction: Vec3;
}

export interface Hit {
  point: Vec3;
  /** Unit, out of the block. */
  normal: Vec3;
  distance: number;
}

/** A displayed tile, and bounds that contain it, mm. */
export interface BoundedTile extends Omit<DisplayedTile, 'key'> {
  bounds: Bounds;
}

/** Bounds of displayed tiles: their squares in the grid, as high as the block. */
export function bounded(tiles: readonly DisplayedTile[], welcome: Welcome): BoundedTile[] {
  const { grid, pitch_mm } = welcome;
  const side = grid.tile * pitch_mm;
  const { min, max } = stockBounds(welcome.stock);
  return tiles.map((tile) => {
    const [x, y] = tileAt(tile.key);
    const left = grid.origin_mm[0] + x * side;
    const front = grid.origin_mm[1] + y * side;
    return {
      ...tile,
      bounds: {
        min: [left - pitch_mm, front - pitch_mm, min[2] - pitch_mm],
        max: [left + side + pitch_mm, front + side + pitch_mm, max[2] + pitch_mm],
      },
    };
  });
}

/** Corners and triangles of a mesh, in its own coordinates. */
interface Triangles {
  corners: Float32Array;
  index: ArrayLike<number>;
  min: Vec3;
  max: Vec3;
}

const BOX_NUMBERS = 6;
const FLAT = 1e-12;
const read = new WeakMap<THREE.BufferGeometry, Triangles>(); // tiles of one shape share a mesh

function trianglesOf(geometry: THREE.BufferGeometry): Triangles {
  const known = read.get(geometry);
  if (known) return known;
  const position = geometry.getAttribute('position');
  const corners = new Float32Array(3 * position.count);
  const min: Vec3 = [Infinity, Infinity, Infinity];
  const max: Vec3 = [-Infinity, -Infinity, -Infinity];
  for (let n = 0; n < position.count; ++n) {
    const at = [position.getX(n), position.getY(n), position.getZ(n)];
    for (let i = 0; i < 3; ++i) {
      corners[3 * n + i] = at[i]!;
      min[i] = Math.min(min[i]!, at[i]!);
      max[i] = Math.max(max[i]!, at[i]!);
    }
  }
  const index = geometry.index?.array ?? Uint32Array.from({ length: position.count }, (_, n) => n);
  const triangles = { corners, index, min, max };
  read.set(geometry, triangles);
  return triangles;
}

/**
 * Where a ray enters the box whose bounds begin at `at`; Infinity if it does not meet it. A ray in a
 * side of the box compares with NaN, which leaves the bounds as they are.
 */
function entry({ origin, direction }: Ray, box: ArrayLike<number>, at: number): number {
  let near = 0;
  let far = Infinity;
  for (let i = 0; i < 3; ++i) {
    const over = 1 / direction[i]!;
    const low = (box[at + i]! - origin[i]!) * over;
    const high = (box[at + 3 + i]! - origin[i]!) * over;
    const first = over < 0 ? high : low;
    const last = over < 0 ? low : high;
    if (first > near) near = first;
    if (last < far) far = last;
  }
  return near <= far ? near : Infinity;
}

export class Surface {
  private readonly boxes_: Float64Array;

  constructor(private readonly tiles_: readonly BoundedTile[]) {
    this.boxes_ = new Float64Array(BOX_NUMBERS * tiles_.length);
    tiles_.forEach(({ bounds }, n) => {
      this.boxes_.set([...bounds.min, ...bounds.max], BOX_NUMBERS * n);
    });
  }

  /** The first place where a ray enters the block, within `reach` mm; null if it does not. */
  hit(ray: Ray, reach = Infinity): Hit | null {
    const met: [at: number, tile: number][] = [];
    for (let n = 0; n < this.tiles_.length; ++n) {
      const at = entry(ray, this.boxes_, BOX_NUMBERS * n);
      if (at < reach) met.push([at, n]);
    }
    met.sort(([a], [b]) => a - b);
    let best: Hit | null = null;
    let nearest = reach;
    for (const [at, n] of met) {
      if (at > nearest) break;
      const found = hitTile(this.tiles_[n]!, ray, nearest);
      if (!found) continue;
      best = found;
      nearest = found.distance;
    }
    return best;
  }

  /**
   * The normal at a hit, averaged over places around it: fine ridges do not turn a tool. `around`
   * has their directions, in the surface's plane; each is probed from `radius` above.
   */
  smoothNormal({ point, normal }: Hit, around: readonly Vec3[], radius: number): Vec3 {
    const near = this.near_(point, 3 * radius);
    const direction = scaled(normal, -1);
    let sum = normal;
    for (const offset of around) {
      const origin = plus(plus(point, offset, radius), normal, radius);
      const probe = near.hit({ origin, direction }, 2 * radius);
      if (probe) sum = plus(sum, probe.normal);
    }
    return unitOf(sum);
  }

  private near_(point: Vec3, radius: number): Surface {
    return new Surface(
      this.tiles_.filter((_, n) => {
        for (let i = 0; i < 3; ++i) {
          const at = BOX_NUMBERS * n + i;
          const isBelow = point[i]! + radius < this.boxes_[at]!;
          if (isBelow || point[i]! - radius > this.boxes_[at + 3]!) return false;
        }
        return true;
      }),
    );
  }
}

/** The nearest hit of a front side closer than `reach`; null without one. */
function hitTile({ geometry, matrix }: BoundedTile, ray: Ray, reach: number): Hit | null {
  const triangles = trianglesOf(geometry);
  const m = matrix.elements; // scales and moves only
  // The ray in the mesh's coordinates, where its parameter is still the distance in mm.
  const scale: Vec3 = [m[0], m[5], m[10]];
  const origin = [0, 1, 2].map((i) => (ray.origin[i]! - m[12 + i]!) / scale[i]!) as Vec3;
  const direction = [0, 1, 2].map((i) => ray.direction[i]! / scale[i]!) as Vec3;
  const box = [...triangles.min, ...triangles.max];
  if (!(entry({ origin, direction }, box, 0) < reach)) return null;
  const found = nearest(triangles, origin, direction, reach);
  if (!found) return null;
  const normal = unitOf([0, 1, 2].map((i) => found.normal[i]! / scale[i]!) as Vec3);
  const point = [0, 1, 2].map((i) => ray.origin[i]! + found.at * ray.direction[i]!) as Vec3;
  return { point, normal, distance: found.at };
}

/** Möller and Trumbore's test of each triangle, from its front. */
function nearest(
  { corners, index }: Triangles,
  origin: Vec3,
  direction: Vec3,
  reach: number,
): { at: number; normal: Vec3 } | null {
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  let best = reach;
  let normal: Vec3 | null = null;
  for (let n = 0; n + 2 < index.length; n += 3) {
    const a = 3 * index[n]!;
    const b = 3 * index[n + 1]!;
    const c = 3 * index[n + 2]!;
    const ax = corners[a]!;
    const ay = corners[a + 1]!;
    const az = corners[a + 2]!;
    const ux = corners[b]! - ax;
    const uy = corners[b + 1]! - ay;
    const uz = corners[b + 2]! - az;
    const vx = corners[c]! - ax;
    const vy = corners[c + 1]! - ay;
    const vz = corners[c + 2]! - az;
    const px = dy * vz - dz * vy;
    const py = dz * vx - dx * vz;
    const pz = dx * vy - dy * vx;
    const det = ux * px + uy * py + uz * pz;
    if (det < FLAT) continue; // from behind, or along the triangle
    const tx = ox - ax;
    const ty = oy - ay;
    const tz = oz - az;
    const u = tx * px + ty * py + tz * pz;
    if (u < 0 || u > det) continue;
    const qx = ty * uz - tz * uy;
    const qy = tz * ux - tx * uz;
    const qz = tx * uy - ty * ux;
    const v = dx * qx + dy * qy + dz * qz;
    if (v < 0 || u + v > det) continue;
    const at = (vx * qx + vy * qy + vz * qz) / det;
    if (at < 0 || at >= best) continue;
    best = at;
    normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  }
  return normal && { at: best, normal };
}
