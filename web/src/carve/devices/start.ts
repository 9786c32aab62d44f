// SPDX-License-Identifier: Apache-2.0
// Where a tool begins that no pointer has put anywhere.

import { stockBounds } from '../../model/session';
import { distance } from '../../model/vector';
import type { Vec3, Welcome } from '../../wire/types';

const ABOVE = 0.05; // the block, of its diagonal

export function diagonalOf({ stock }: Pick<Welcome, 'stock'>): number {
  const { min, max } = stockBounds(stock);
  return distance(min, max);
}

/** Over the middle of the block's top, mm. */
export function overBlock(welcome: Pick<Welcome, 'stock'>): Vec3 {
  const { min, max } = stockBounds(welcome.stock);
  const z = max[2] + ABOVE * diagonalOf(welcome);
  return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, z];
}
