// SPDX-License-Identifier: Apache-2.0
// Vectors of three numbers.

import type { Vec3 } from '../wire/types';

export function plus(a: Vec3, b: Vec3, times = 1): Vec3 {
  return [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];
}

export function minus(a: Vec3, b: Vec3): Vec3 {
  return plus(a, b, -1);
}

export function scaled(a: Vec3, factor: number): Vec3 {
  return [a[0] * factor, a[1] * factor, a[2] * factor];
}

export function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a: Vec3, b: Vec3): Vec3 {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function distance(a: Vec3, b: Vec3): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** The unit vector of a direction; zero stays zero. */
export function unitOf(a: Vec3): Vec3 {
  return scaled(a, 1 / (Math.hypot(...a) || 1));
}

/** Two unit vectors that span the plane across a unit vector; with it they are right-handed. */
export function across(normal: Vec3): [Vec3, Vec3] {
  const helper: Vec3 = Math.abs(normal[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const u = unitOf(cross(helper, normal));
  return [u, cross(normal, u)];
}

/** Rotates by a rotation vector: about its direction, by its length in radians (Rodrigues). */
export function rotated(a: Vec3, turn: Vec3): Vec3 {
  const angle = Math.hypot(...turn);
  const u = unitOf(turn);
  const around = plus(scaled(a, Math.cos(angle)), cross(u, a), Math.sin(angle));
  return plus(around, u, dot(u, a) * (1 - Math.cos(angle)));
}
