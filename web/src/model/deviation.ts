// SPDX-License-Identifier: Apache-2.0
// How far a block is from the part that it is to become: shares, bars and colors of signed
// deviations, positive where material was left.

import type { Vec3 } from '../wire/types';

/** A place at which the deviation is greatest within its surroundings. */
export interface DeviationPlace {
  mm: number;
  at_mm: Vec3;
  /** Unit vector out of the material. */
  normal: Vec3;
}

/** The server's survey of a whole block. */
export interface DeviationSurvey {
  area_mm2: number;
  least_mm: number;
  greatest_mm: number;
  mean_mm: number;
  rms_mm: number;
  /** In equal steps of the area, from the least to the greatest. */
  quantiles_mm: number[];
  /** The worst first. */
  worst: DeviationPlace[];
  state_hash: string;
}

/** The share of the surface whose deviation is at most `mm`, by linear interpolation. */
export function shareBelow(quantiles: readonly number[], mm: number): number {
  const last = quantiles.length - 1;
  if (last < 1 || mm < quantiles[0]!) return 0;
  let low = 0; // the greatest n with quantiles[n] <= mm
  for (let step = 2 ** Math.ceil(Math.log2(last + 1)); step >= 1; step /= 2)
    if (low + step <= last && quantiles[low + step]! <= mm) low += step;
  if (low === last) return 1;
  const [from, to] = [quantiles[low]!, quantiles[low + 1]!];
  return (low + (mm - from) / (to - from)) / last;
}

/** The share of the surface that is within a tolerance of the part. */
export function shareWithin(quantiles: readonly number[], toleranceMm: number): number {
  // A value exactly at the lower limit is within, too.
  const below = shareBelow(quantiles, -toleranceMm * (1 + 1e-12));
  return shareBelow(quantiles, toleranceMm) - below;
}

/**
 * The shares of the surface in equal bins from -range to range; values beyond the range count in
 * the outer bins.
 */
export function binShares(quantiles: readonly number[], rangeMm: number, bins: number): number[] {
  const edges = Array.from({ length: bins + 1 }, (_, n) => rangeMm * ((2 * n) / bins - 1));
  edges[0] = -Infinity;
  edges[bins] = Infinity;
  const below = edges.map((mm) => shareBelow(quantiles, mm));
  return below.slice(1).map((share, n) => share - below[n]!);
}

/** Of 1, 2 and 5 times a power of ten the least that is not below a value above 0. */
export function roundedUp(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = [1, 2, 5, 10].find((step) => step * power >= value * (1 - 1e-9)) ?? 10;
  return Number((digit * power).toPrecision(1));
}

/** Where colors are full: beyond it is a hundredth of the surface, but never within two tolerances. */
export function rangeOf({ quantiles_mm: quantiles }: DeviationSurvey, toleranceMm: number): number {
  const last = quantiles.length - 1;
  const at = (share: number): number => Math.abs(quantiles[Math.round(share * last)] ?? 0);
  return roundedUp(Math.max(2 * toleranceMm, at(0.005), at(0.995)));
}

/** Red, green and blue of a deviation as CSS writes them: gray within the tolerance. */
export function colorOf(mm: number, toleranceMm: number, rangeMm: number): string {
  const beyond = (Math.abs(mm) - toleranceMm) / (rangeMm - toleranceMm);
  if (beyond <= 0) return '#c9ccc8';
  const share = 0.5 + 0.5 * Math.min(1, beyond);
  const end = mm < 0 ? [33, 84, 196] : [196, 44, 30];
  const mixed = end.map((value) => Math.round(214 + (value - 214) * share));
  return `rgb(${mixed.join(' ')})`;
}
