// SPDX-License-Identifier: Apache-2.0
// Force and torque along a path, as arrows at the places where they were greatest (Fig. 16 of the
// paper).

import type { Vec3 } from '../wire/types';

/** The motion with the greatest force of a span: where its tip ended, and its wrench. */
export interface WrenchPeak {
  tipMm: Vec3;
  forceN: Vec3;
  torqueNmm: Vec3;
}

/** The peaks of `GET …/forces`; none from a server that does not send them. */
export function peaksOf(body: Record<string, unknown>): WrenchPeak[] {
  const peak = (body['peak'] ?? {}) as Record<string, unknown>;
  const [tips, forces, torques] = ['tip_mm', 'force_n', 'torque_nmm'].map((name) => {
    const vectors = peak[name];
    return Array.isArray(vectors) ? (vectors as Vec3[]) : [];
  }) as [Vec3[], Vec3[], Vec3[]];
  const count = Math.min(tips.length, forces.length, torques.length);
  return tips
    .slice(0, count)
    .map((tipMm, n) => ({ tipMm, forceN: forces[n]!, torqueNmm: torques[n]! }));
}

/** The greatest force and torque of peaks. */
export function greatestOf(peaks: readonly WrenchPeak[]): { forceN: number; torqueNmm: number } {
  const most = (of: (peak: WrenchPeak) => Vec3): number =>
    peaks.reduce((greatest, peak) => Math.max(greatest, Math.hypot(...of(peak))), 0);
  return { forceN: most(({ forceN }) => forceN), torqueNmm: most(({ torqueNmm }) => torqueNmm) };
}

/** At most `most` peaks: the one with the greatest force of each of as many equal groups. */
export function thinned(peaks: readonly WrenchPeak[], most: number): WrenchPeak[] {
  const size = Math.max(1, Math.ceil(peaks.length / most));
  const groups = Array.from({ length: Math.ceil(peaks.length / size) }, (_, n) =>
    peaks.slice(n * size, (n + 1) * size),
  );
  return groups.map((group) =>
    group.reduce((best, one) =>
      Math.hypot(...one.forceN) > Math.hypot(...best.forceN) ? one : best,
    ),
  );
}

const HEAD = 0.22; // of the arrow's length
const HEAD_WIDTH = 0.09;

/** Any unit vector at right angles to a unit vector. */
function across([x, y, z]: Vec3): Vec3 {
  const [a, b] = Math.abs(z) < 0.9 ? [-y, x] : [0, -z];
  const c = Math.abs(z) < 0.9 ? 0 : y;
  const size = Math.hypot(a, b, c);
  return [a / size, b / size, c / size];
}

/**
 * Arrows that begin at the tips, of three lines each: shaft and two strokes of the head. A vector of
 * `full` is `lengthMm` long.
 */
export function arrowLines(
  peaks: readonly WrenchPeak[],
  of: (peak: WrenchPeak) => Vec3,
  full: number,
  lengthMm: number,
): Float32Array {
  const positions: number[] = [];
  for (const peak of peaks) {
    const vector = of(peak);
    const size = Math.hypot(...vector);
    if (!(size > 0) || !(full > 0)) continue;
    const along = vector.map((value) => value / size) as Vec3;
    const long = (size / full) * lengthMm;
    const side = across(along);
    const at = (share: number, aside: number): Vec3 =>
      peak.tipMm.map((p, k) => p + long * (share * along[k]! + aside * side[k]!)) as Vec3;
    const end = at(1, 0);
    const barbs = [HEAD_WIDTH, -HEAD_WIDTH].flatMap((aside) => [...end, ...at(1 - HEAD, aside)]);
    positions.push(...peak.tipMm, ...end, ...barbs);
  }
  return new Float32Array(positions);
}
