// SPDX-License-Identifier: Apache-2.0
// Whether a tool at a pose meets the surface anywhere but at its tip: with the side of its cutter,
// its shank or its holder. Rays run down the outside of the tool, from its upper end.

import { across, plus, scaled } from '../model/vector';
import type { OutlinePoint, ToolProfile } from '../model/tool_profile';
import type { Vec3 } from '../wire/types';
import type { Surface } from './surface';
import type { Pose } from './tool/path_queue';
import { turned } from './tool/vectors';

const RAYS = 6; // around the axis
const TILTS_RAD = [0.35, 0.7, 1.05];

/** A cylinder around the axis, from one height above the tip to another, mm. */
interface Sleeve {
  radius: number;
  from: number;
  to: number;
}

function greatestRadius(outline: readonly OutlinePoint[]): number {
  return Math.max(0, ...outline.map(([r]) => r));
}

/** The parts of a tool above its cut of `depthMm`, where the surface is level across the axis. */
function sleeves({ lengthMm, radiusMm, body }: ToolProfile, depthMm: number): Sleeve[] {
  const cutter = { radius: radiusMm, from: depthMm + radiusMm, to: lengthMm };
  const outline = body.pieces.flat();
  const all = [cutter, { radius: greatestRadius(outline), from: lengthMm, to: body.topMm }];
  return all.filter(({ radius, from, to }) => radius > 0 && to > from);
}

/** Directions of unit length around an axis. */
function around(axis: Vec3): Vec3[] {
  const [right, front] = across(axis);
  return Array.from({ length: RAYS }, (_, n) => {
    const angle = (2 * Math.PI * n) / RAYS;
    return plus(scaled(right, Math.cos(angle)), front, Math.sin(angle));
  });
}

/**
 * Whether the tool meets the surface above its tip, by more than its radius over the depth of the
 * cut. Holds for a tool that stands across the surface.
 */
export function meetsAbove(
  surface: Pick<Surface, 'hit'>,
  { tip, axis }: Pose,
  profile: ToolProfile,
  depthMm: number,
): boolean {
  const down = scaled(axis, -1);
  const sides = around(axis);
  return sleeves(profile, depthMm).some(({ radius, from, to }) =>
    sides.some((side) => {
      const origin = plus(plus(tip, axis, to), side, radius);
      const hit = surface.hit({ origin, direction: down }, to - from);
      return hit !== null && hit.at > 0 && hit.at < to - from;
    }),
  );
}

/** Axes that lean away from a normal, the nearest ones first. */
export function* leaningFrom(normal: Vec3): Generator<Vec3> {
  for (const tilt of TILTS_RAD) for (const side of around(normal)) yield turned(normal, side, tilt);
}
