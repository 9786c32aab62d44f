// SPDX-License-Identifier: Apache-2.0

import type { Vec3 } from './vec3';

/** Where a device can bring the tip of its tool: a box in the block, which may be turned. */
export interface Reach {
  center_mm: Vec3;
  /** Half of its edges. */
  half_mm: Vec3;
  /** Rotation vector: turns the box about its center. */
  turn_rad: Vec3;
  /** Millimeters in the block per millimeter of the device. */
  scale: number;
}
