// SPDX-License-Identifier: Apache-2.0
// Where pins are on the surface, which changes under them.

import type { Pin, Vec3 } from '../wire/types';
import { hitsOf } from './surface';
import type { Piece } from './surface';

/**
 * Where a pin is on the surface as it is now: the nearest place on its normal at which the material
 * ends. Where nothing is left on it, the place where it was set.
 */
export function placeOf({ at_mm, normal }: Pin, pieces: readonly Piece[]): Vec3 {
  let nearest: Vec3 = at_mm;
  let least = Infinity;
  for (const { at, point, enters } of hitsOf(pieces, at_mm, normal)) {
    if (enters || Math.abs(at) >= least) continue;
    least = Math.abs(at);
    nearest = point;
  }
  return nearest;
}
