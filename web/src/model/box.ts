// SPDX-License-Identifier: Apache-2.0

import type { Vec3 } from '../wire/types';

/** A box along the axes, by two opposite corners. */
export interface Box {
  min: Vec3;
  max: Vec3;
}
