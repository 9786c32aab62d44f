// SPDX-License-Identifier: Apache-2.0

import type { Vec3 } from '../wire/types';

/** A line of a program, and a point on the surface that it cut. */
export interface ProgramPlace {
  program: number;
  line: number;
  place: Vec3;
}
