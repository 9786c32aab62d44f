// SPDX-License-Identifier: Apache-2.0
// Where a participant's device reaches in the block.

import type { Reach } from '../wire/reach';
import type { Vec3 } from '../wire/types';
import { minus, rotated, scaled } from './vector';

function corners(min: Vec3, max: Vec3): Vec3[] {
  const all: Vec3[] = [];
  for (const x of [min[0], max[0]])
    for (const y of [min[1], max[1]]) for (const z of [min[2], max[2]]) all.push([x, y, z]);
  return all;
}

/** Whether the device can bring its tool to every corner of a box. */
export function reachesAll({ center_mm, half_mm, turn_rad }: Reach, min: Vec3, max: Vec3): boolean {
  const back = scaled(turn_rad, -1);
  return corners(min, max).every((corner) =>
    rotated(minus(corner, center_mm), back).every((at, axis) => Math.abs(at) <= half_mm[axis]!),
  );
}
