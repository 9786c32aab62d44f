// SPDX-License-Identifier: Apache-2.0
// Maps a point of the picture to a point of the block: the point of the displayed surface, or of
// the section, moved to a corner or an edge nearby.

import { firstBehind } from '../../model/section';
import type { Plane } from '../../model/section';
import { snapTo } from '../../model/snap';
import type { Snapped } from '../../model/snap';
import { hitsOf, normalAround, trianglesNear } from '../../model/surface';
import { dot } from '../../model/vector';
import type { DisplayedSurface } from '../../view/displayed_surface';
import type { Viewer } from '../../view/viewer';
import type { Vec3 } from '../../wire/types';
import { Vector3 } from 'three';

const SNAP_PX = 10;

export interface Picked {
  snapped: Snapped;
  /** The point itself, and the unit vector out of the material there. */
  point: Vec3;
  normal: Vec3;
}

/** Without the triangles that the section has cut away. */
function kept(triangles: Float64Array, plane: Plane | null): Float64Array {
  if (!plane) return triangles;
  const all: number[] = [];
  for (let at = 0; at < triangles.length; at += 9) {
    const isKept = [0, 3, 6].some((n) => {
      const corner = [...triangles.subarray(at + n, at + n + 3)] as Vec3;
      return dot(corner, plane.normal) < plane.offset;
    });
    if (isKept) all.push(...triangles.subarray(at, at + 9));
  }
  return Float64Array.from(all);
}

export class Picker {
  constructor(
    private readonly viewer: Viewer,
    private readonly surface: DisplayedSurface,
  ) {}

  /**
   * @param x, y CSS pixels from the picture's upper left corner
   * @param outline of the section
   * @param roughMm within so much of a point its normal is a mean
   */
  at(
    x: number,
    y: number,
    plane: Plane | null,
    outline: ArrayLike<number>,
    roughMm: number,
  ): Picked | null {
    const ray = this.viewer.ray(x, y);
    const [origin, direction] = [ray.origin.toArray(), ray.direction.toArray()];
    const { pieces } = this.surface;
    const hit = firstBehind(hitsOf(pieces, origin, direction), origin, direction, plane);
    if (!hit) return null;
    const { point } = hit;
    const radius = SNAP_PX * this.viewer.pixelMm(new Vector3(...point));
    const near = kept(trianglesNear(pieces, point, radius), plane);
    const snapped = snapTo(point, near, radius, outline);
    const isCutAway = plane && dot(snapped.point, plane.normal) > plane.offset + 1e-6;
    const normal = normalAround(trianglesNear(pieces, point, roughMm), hit.normal);
    return { snapped: isCutAway ? { kind: 'face', point } : snapped, point, normal };
  }
}
