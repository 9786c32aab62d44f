// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { boxCenter, fitDistance } from '../src/model/fit';

describe('fit', () => {
  const cube = {
    min: [-1, -1, -1] as [number, number, number],
    max: [1, 1, 1] as [number, number, number],
  };

  it('places the near face of a cube just inside the picture', () => {
    expect(fitDistance(cube, [0, -1, 0], 0.5, 0.5)).toBeCloseTo(1 + 1 / 0.5, 9);
  });

  it('depends on the narrower side of the picture', () => {
    expect(fitDistance(cube, [0, -1, 0], 0.25, 0.5)).toBeCloseTo(1 + 1 / 0.25, 9);
    expect(fitDistance(cube, [0, -1, 0], 0.5, 0.25)).toBeCloseTo(1 + 1 / 0.25, 9);
  });

  it('keeps every corner of an asymmetric box in view from all directions', () => {
    const box = {
      min: [5, -40, 2] as [number, number, number],
      max: [90, 11, 9] as [number, number, number],
    };
    for (let i = 0; i < 200; ++i) {
      const [a, b] = [i * 0.7, Math.sin(i * 1.3) * 1.5];
      const to = [Math.cos(a) * Math.cos(b), Math.sin(a) * Math.cos(b), Math.sin(b)] as const;
      const distance = fitDistance(box, to, 0.4, 0.3);
      const camera = boxCenter(box).map((c, k) => c + distance * to[k]!);
      for (const corner of [
        box.min,
        box.max,
        [5, 11, 2],
        [90, -40, 9],
        [5, -40, 9],
        [90, 11, 2],
        [5, 11, 9],
        [90, -40, 2],
      ]) {
        const arm = corner.map((c, k) => c - camera[k]!);
        const depth = -(arm[0]! * to[0] + arm[1]! * to[1] + arm[2]! * to[2]);
        const sideways = arm[0]! * -Math.sin(a) + arm[1]! * Math.cos(a);
        expect(depth).toBeGreaterThan(0);
        expect(Math.abs(sideways) / depth).toBeLessThan(0.4 + 1e-9);
      }
    }
  });
});
