// SPDX-License-Identifier: Apache-2.0
// The common scale of all force and torque arrows, so that they can be compared.

import type { ForceHistory } from './forces';

/** Of force and torque, in arrows. */
export const WRENCH_COLORS = { force: '#1f66e5', torque: '#d8262c' } as const;
const WRENCH_COLORS_ON_DARK = { force: '#7aa7ff', torque: '#ff7a80' } as const;

/** The same for plots and scale, which lie on the page's background. */
export function wrenchColors(dark: boolean): { force: string; torque: string } {
  return dark ? WRENCH_COLORS_ON_DARK : WRENCH_COLORS;
}

const UPDATE_EVERY_MS = 250;
const FULL_PER_TYPICAL = 2;
const LEAST_FULL_N = 0.1; // smaller scales would display noise
const LEAST_FULL_NMM = 1;

export class ArrowScale {
  /** The force and torque of a full-length arrow. */
  forceFullN = 1;
  torqueFullNmm = 1;
  private updatedMs_ = -Infinity;

  /**
   * Adapts the scale to the participants' forces, four times a second. It follows the RMS, not the
   * maximum: a single peak must not shrink all arrows for as long as the history lasts.
   */
  update(participants: readonly { forces: ForceHistory }[], nowMs: number): void {
    if (nowMs - this.updatedMs_ < UPDATE_EVERY_MS) return;
    this.updatedMs_ = nowMs;
    let forceN = LEAST_FULL_N;
    let torqueNmm = LEAST_FULL_NMM;
    for (const { forces } of participants) {
      const { typical } = forces;
      forceN = Math.max(forceN, FULL_PER_TYPICAL * typical.forceN);
      torqueNmm = Math.max(torqueNmm, FULL_PER_TYPICAL * typical.torqueNmm);
    }
    this.forceFullN = roundUp125(forceN);
    this.torqueFullNmm = roundUp125(torqueNmm);
  }
}

/**
 * Returns the smallest number of the series 1, 2, 5, 10, 20, 50 … (and 0.5, 0.2 …) >= `value`: the
 * reference of an arrow scale.
 */
export function roundUp125(value: number): number {
  if (!(value > 0)) return 1;
  const decade = 10 ** Math.floor(Math.log10(value));
  for (const step of [1, 2, 5]) {
    if (value <= step * decade * (1 + 1e-9)) return step * decade;
  }
  return 10 * decade;
}
