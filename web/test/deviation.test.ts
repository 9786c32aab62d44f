// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import {
  binShares,
  colorOf,
  rangeOf,
  roundedUp,
  shareBelow,
  shareWithin,
} from '../src/model/deviation';
import type { DeviationSurvey } from '../src/model/deviation';

/** A tenth of the surface at every step from -1 to 1. */
const EVEN = Array.from({ length: 11 }, (_, n) => (n - 5) / 5);
/** Most of the surface is where it should be. */
const FLAT = [-0.3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.4];

function surveyOf(quantiles: number[]): DeviationSurvey {
  return {
    area_mm2: 1,
    least_mm: quantiles[0]!,
    greatest_mm: quantiles.at(-1)!,
    mean_mm: 0,
    rms_mm: 0,
    quantiles_mm: quantiles,
    worst: [],
    state_hash: '',
  };
}

describe('shares of the surface', () => {
  it('are interpolated between quantiles', () => {
    expect(shareBelow(EVEN, -1.01)).toBe(0);
    expect(shareBelow(EVEN, -1)).toBe(0);
    expect(shareBelow(EVEN, -0.9)).toBeCloseTo(0.05, 12);
    expect(shareBelow(EVEN, 0)).toBeCloseTo(0.5, 12);
    expect(shareBelow(EVEN, 1)).toBe(1);
    expect(shareBelow(EVEN, 7)).toBe(1);
  });

  it('count the surface that is exactly as it should be', () => {
    expect(shareWithin(FLAT, 0.001)).toBeCloseTo(0.8, 2);
    expect(shareWithin([0, 0, 0], 0.001)).toBe(1);
    expect(shareWithin([0.2, 0.2, 0.2], 0.1)).toBe(0);
    expect(shareWithin([-0.1, -0.1, 0.1], 0.1)).toBe(1); // the limits are within
  });

  it('of nothing are none', () => {
    expect(shareBelow([], 1)).toBe(0);
    expect(shareWithin([], 1)).toBe(0);
  });

  it('in bins add up to all of it, with values beyond the range in the outer bins', () => {
    const shares = binShares(EVEN, 0.5, 5);
    expect(shares.reduce((sum, share) => sum + share)).toBeCloseTo(1, 12);
    expect(shares[2]).toBeCloseTo(0.1, 12); // of -0.1 to 0.1
    expect(shares[0]).toBeCloseTo(0.35, 12); // -1 to -0.3
    expect(shares[4]).toBeCloseTo(0.35, 12);
  });
});

describe('the range of the colors', () => {
  it('is a round figure that is not smaller', () => {
    expect([0.011, 0.02, 0.05, 3.3, 7, 10].map(roundedUp)).toEqual([0.02, 0.02, 0.05, 5, 10, 10]);
    expect(roundedUp(0.00031)).toBe(0.0005);
  });

  it('leaves out a hundredth of the surface, but never two tolerances', () => {
    const quantiles = Array.from({ length: 1001 }, (_, n) => (n < 997 ? 0.03 : 50));
    expect(rangeOf(surveyOf(quantiles), 0.01)).toBe(0.05);
    expect(rangeOf(surveyOf(quantiles), 0.1)).toBe(0.2);
  });
});

describe('the color of a deviation', () => {
  it('is gray within the tolerance, and tells the sides apart beyond', () => {
    expect(colorOf(0.05, 0.05, 1)).toBe(colorOf(-0.02, 0.05, 1));
    expect(colorOf(0.051, 0.05, 1)).not.toBe(colorOf(0.05, 0.05, 1));
    const channels = (text: string): number[] => text.match(/\d+/g)!.map(Number);
    const [red, , blue] = channels(colorOf(1, 0.05, 1)) as [number, number, number];
    expect(red).toBeGreaterThan(blue + 100);
    const [less, , more] = channels(colorOf(-1, 0.05, 1)) as [number, number, number];
    expect(more).toBeGreaterThan(less + 100);
    expect(colorOf(40, 0.05, 1)).toBe(colorOf(1, 0.05, 1));
  });
});
