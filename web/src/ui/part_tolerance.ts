// SPDX-License-Identifier: Apache-2.0
// The tolerance with which the block is compared with a part, as the user has chosen it.

import { roundedUp } from '../model/deviation';
import { recall, remember } from '../strings/memory';

const KEY = 'tolerance';

/** mm; a quarter of the pitch unless the user has chosen one. */
export function partTolerance(pitchMm = 0.2): number {
  return Number(recall(KEY)) || roundedUp(pitchMm / 4);
}

export function rememberPartTolerance(mm: number): void {
  remember(KEY, String(mm));
}
