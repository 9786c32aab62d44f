// SPDX-License-Identifier: Apache-2.0
// Directions between two others.

import { cross, dot, minus, plus, scaled, unitOf } from '../../model/vector';
import type { Vec3 } from '../../wire/types';

export function lerp(a: Vec3, b: Vec3, part: number): Vec3 {
  return plus(a, minus(b, a), part);
}

/** The angle between two unit vectors, rad. */
export function angleBetween(a: Vec3, b: Vec3): number {
  return Math.atan2(Math.hypot(...cross(a, b)), dot(a, b));
}

/** Turns the unit vector `from` by `angle` towards another one, in the plane of both. */
export function turned(from: Vec3, towards: Vec3, angle: number): Vec3 {
  const side = unitOf(minus(towards, scaled(from, dot(from, towards))));
  return unitOf(plus(scaled(from, Math.cos(angle)), side, Math.sin(angle)));
}

/** The unit vector at a part of the turn from one to another. */
export function slerp(from: Vec3, to: Vec3, part: number): Vec3 {
  return turned(from, to, part * angleBetween(from, to));
}
