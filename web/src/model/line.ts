// SPDX-License-Identifier: Apache-2.0
// The one test of a line against triangles and boxes.

import type { Vec3 } from '../wire/types';

type Axis = 0 | 1 | 2;

/** A line, or the ray from its origin. Places along it are in lengths of `direction`. */
export class Line {
  // The axis along which it goes farthest and the two after it, with the lengths along them.
  private readonly z_: Axis;
  private readonly x_: Axis;
  private readonly y_: Axis;
  private readonly shearX_: number;
  private readonly shearY_: number;

  constructor(
    readonly origin: Vec3,
    readonly direction: Vec3,
  ) {
    const [x, y, z] = direction.map(Math.abs) as Vec3;
    this.z_ = x > y ? (x > z ? 0 : 2) : y > z ? 1 : 2;
    this.x_ = ((this.z_ + 1) % 3) as Axis;
    this.y_ = ((this.z_ + 2) % 3) as Axis;
    this.shearX_ = direction[this.x_] / direction[this.z_];
    this.shearY_ = direction[this.y_] / direction[this.z_];
  }

  /**
   * Where the line meets the triangle whose nine numbers begin at `at`; NaN: nowhere. Neighboring
   * triangles compute the same numbers for their edge, so that no line passes between them (Woop,
   * Benthin, Wald 2013).
   */
  meets(corners: Float64Array, at: number): number {
    const { x_: x, y_: y, z_: z, shearX_: shearX, shearY_: shearY, origin } = this;
    const az = corners[at + z]! - origin[z];
    const bz = corners[at + 3 + z]! - origin[z];
    const cz = corners[at + 6 + z]! - origin[z];
    const ax = corners[at + x]! - origin[x] - shearX * az;
    const bx = corners[at + 3 + x]! - origin[x] - shearX * bz;
    const cx = corners[at + 6 + x]! - origin[x] - shearX * cz;
    const ay = corners[at + y]! - origin[y] - shearY * az;
    const by = corners[at + 3 + y]! - origin[y] - shearY * bz;
    const cy = corners[at + 6 + y]! - origin[y] - shearY * cz;
    const u = cx * by - cy * bx;
    const v = ax * cy - ay * cx;
    const w = bx * ay - by * ax;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return Number.NaN;
    const sum = u + v + w;
    return sum === 0 ? Number.NaN : (u * az + v * bz + w * cz) / (sum * this.direction[z]);
  }

  /**
   * Where the line, from `least` on, enters the box of the three numbers at `at` of `min` and `max`;
   * Infinity: it does not meet it. A line in a side of the box compares with NaN, which leaves the
   * bounds as they are.
   */
  enters(min: ArrayLike<number>, max: ArrayLike<number>, at: number, least: number): number {
    let near = least;
    let far = Infinity;
    for (let n = 0; n < 3; n += 1) {
      const over = 1 / this.direction[n]!;
      const low = (min[at + n]! - this.origin[n]!) * over;
      const high = (max[at + n]! - this.origin[n]!) * over;
      const first = over < 0 ? high : low;
      const last = over < 0 ? low : high;
      if (first > near) near = first;
      if (last < far) far = last;
    }
    return near <= far ? near : Infinity;
  }
}
