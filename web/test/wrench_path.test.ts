// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { arrowLines, greatestOf, peaksOf, thinned } from '../src/model/wrench_path';
import type { WrenchPeak } from '../src/model/wrench_path';
import type { Vec3 } from '../src/wire/types';

const peak = (tipMm: Vec3, forceN: Vec3, torqueNmm: Vec3 = [0, 0, 0]): WrenchPeak => ({
  tipMm,
  forceN,
  torqueNmm,
});
const ALONG = Array.from({ length: 10 }, (_, n) =>
  peak([n, 0, 0], [-1 - (n % 3), 0, 0], [0, n, 0]),
);

describe('force and torque along a path', () => {
  it('are read from an answer, up to the shortest column', () => {
    const two = [
      [1, 0, 0],
      [2, 0, 0],
    ];
    const body = { peak: { tip_mm: two, force_n: two, torque_nmm: two.slice(0, 1) } };
    expect(peaksOf(body)).toEqual([peak([1, 0, 0], [1, 0, 0], [1, 0, 0])]);
    expect(peaksOf({})).toEqual([]);
  });

  it('have the greatest values of all peaks', () => {
    expect(greatestOf(ALONG)).toEqual({ forceN: 3, torqueNmm: 9 });
    expect(greatestOf([])).toEqual({ forceN: 0, torqueNmm: 0 });
  });

  it('keep the greatest force when they are thinned', () => {
    expect(thinned(ALONG, 20)).toEqual(ALONG);
    const few = thinned(ALONG, 3);
    expect(few.length).toBeLessThanOrEqual(3);
    expect(few.map(({ forceN }) => forceN[0])).toEqual([-3, -3, -3]);
    expect(greatestOf(few).forceN).toBe(3);
    expect(thinned([], 3)).toEqual([]);
  });

  it('are arrows from the tip, in proportion to the greatest', () => {
    const of = ({ forceN }: WrenchPeak): Vec3 => forceN;
    for (const force of [
      [0, 0, 2],
      [0, -2, 0],
      [2, 0, 0],
    ] as Vec3[]) {
      const points = [...arrowLines([peak([5, 6, 7], force)], of, 4, 10)];
      expect(points).toHaveLength(3 * 2 * 3);
      expect(points.slice(0, 3)).toEqual([5, 6, 7]);
      const end = points.slice(3, 6);
      expect(end).toEqual([5, 6, 7].map((value, k) => value + 2.5 * force[k]!));
      for (const stroke of [6, 12]) {
        expect(points.slice(stroke, stroke + 3)).toEqual(end);
        const barb = points.slice(stroke + 3, stroke + 6);
        expect(Math.hypot(...barb.map((value, k) => value - end[k]!))).toBeLessThan(1.5);
      }
    }
  });

  it('have no arrow where there is no force', () => {
    const of = ({ torqueNmm }: WrenchPeak): Vec3 => torqueNmm;
    expect(arrowLines([peak([0, 0, 0], [1, 0, 0])], of, 0, 10)).toHaveLength(0);
    expect(arrowLines(ALONG, of, 9, 10)).toHaveLength(9 * 18); // one torque is zero
  });
});
