// SPDX-License-Identifier: Apache-2.0
// Where a participant's device reaches in the block.

import type { Reach } from '../wire/reach';
import type { Vec3 } from '../wire/types';

/** Rotates by a rotation vector (Rodrigues). */
export function rotated(v: Vec3, turn: Vec3): Vec3 {
  const angle = Math.hypot(...turn);
  if (angle === 0) return v;
  const [x, y, z] = turn.map((component) => component / angle) as unknown as Vec3;
  const cross = [y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0]] as const;
  const along = (x * v[0] + y * v[1] + z * v[2]) * (1 - Math.cos(angle));
  const cos = Math.cos(angle);
  const sin = Math.sin(angle);
  return [
    v[0] * cos + cross[0] * sin + x * along,
    v[1] * cos + cross[1] * sin + y * along,
    v[2] * cos + cross[2] * sin + z * along,
  ];
}

function corners(min: Vec3, max: Vec3): Vec3[] {
  const all: Vec3[] = [];
  for (const x of [min[0], max[0]])
    for (const y of [min[1], max[1]]) for (const z of [min[2], max[2]]) all.push([x, y, z]);
  return all;
}

/** Whether the device can bring its tool to every corner of a box. */
export function reachesAll({ center_mm, half_mm, turn_rad }: Reach, min: Vec3, max: Vec3): boolean {
  const back: Vec3 = [-turn_rad[0], -turn_rad[1], -turn_rad[2]];
  return corners(min, max).every((corner) => {
    const off: Vec3 = [
      corner[0] - center_mm[0],
      corner[1] - center_mm[1],
      corner[2] - center_mm[2],
    ];
    return rotated(off, back).every((value, axis) => Math.abs(value) <= half_mm[axis]!);
  });
}
