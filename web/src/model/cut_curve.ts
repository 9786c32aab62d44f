// SPDX-License-Identifier: Apache-2.0
// Forces and removal along an NC program, over its time.

import type { ForceCurve } from './force_curve';

const CM3_PER_MIN = 60 / 1000; // mm³/s

/**
 * Columns of equal length: a column has the cut between the time before and its own in `timesS`.
 */
export interface CutCurve {
  timesS: number[];
  /** The greatest force. */
  forcesN: number[];
  /** The mean rate of removal, cm³/min. */
  removals: number[];
}

/** Of spans that follow each other. Those that take no time are left out. */
export function cutCurveOf({ endS, maxN, removedMm3 }: ForceCurve): CutCurve {
  const curve: CutCurve = { timesS: [0], forcesN: [maxN[0] ?? 0], removals: [] };
  let beganS = 0;
  endS.forEach((timeS, n) => {
    const lengthS = timeS - beganS;
    if (!(lengthS > 0)) return;
    curve.timesS.push(timeS);
    curve.forcesN.push(maxN[n]!);
    curve.removals.push((CM3_PER_MIN * removedMm3[n]!) / lengthS);
    beganS = timeS;
  });
  curve.removals.unshift(curve.removals[0] ?? 0);
  return curve;
}

/** The index of the span at a time; -1: nothing was cut then, or not yet. */
export function spanAt({ timesS }: CutCurve, timeS: number): number {
  return timeS < 0 ? -1 : timesS.findIndex((endS, n) => n > 0 && endS >= timeS);
}
