// SPDX-License-Identifier: Apache-2.0
// How far a stick or the cap of a 3D mouse is pushed, and what that makes of the tool's pose.

import { plus, scaled } from '../../model/vector';
import type { Vec3 } from '../../wire/types';
import type { Pose } from '../tool/path_queue';
import { angleBetween, turned } from '../tool/vectors';

/** Each part from -1 to 1. */
export interface Deflection {
  /** To the right, up, and towards the viewer. */
  move: Vec3;
  /** The tool's upper end, to the right and towards the viewer. */
  lean: readonly [right: number, towards: number];
  /** How deep the tool is pressed, 0 to 1; 0: it does not cut. */
  press: number;
}

/** Unit vectors in the block's coordinates, both level. */
export interface Sides {
  right: Vec3;
  towards: Vec3;
}

export const AT_REST: Deflection = { move: [0, 0, 0], lean: [0, 0], press: 0 };
const DEAD = 0.12; // sticks do not return to the same place
const LEAN_RAD_PER_S = 1.2;

/** Without the dead part in the middle, and finer near it. */
export function eased(value: number, dead = DEAD): number {
  const beyond = Math.max(0, Math.abs(value) - dead) / (1 - dead);
  return Math.sign(value) * Math.min(1, beyond) ** 2;
}

export function isAtRest({ move, lean, press }: Deflection): boolean {
  return press === 0 && [...move, ...lean].every((part) => part === 0);
}

/** Returns where a pose has got to after a time, in s, at a full speed in mm/s. */
export function moved(
  { tip, axis }: Pose,
  { move, lean }: Deflection,
  { right, towards }: Sides,
  timeS: number,
  speedMmPerS: number,
): Pose {
  const by = plus(plus(scaled(right, move[0]), towards, move[2]), [0, 0, 1], move[1]);
  const to = plus(scaled(right, lean[0]), towards, lean[1]);
  const angle = Math.hypot(...lean) * LEAN_RAD_PER_S * timeS;
  const direction = scaled(to, 1 / (Math.hypot(...to) || 1));
  // A tool that lies in this direction already leans no farther.
  const isFree = angle > 0 && angleBetween(axis, direction) > angle;
  return {
    tip: plus(tip, by, speedMmPerS * timeS),
    axis: isFree ? turned(axis, direction, angle) : axis,
  };
}
