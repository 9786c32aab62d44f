// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Place } from '../../src/carve/place';
import { Steady } from '../../src/carve/steady';

const at = (x: number, y = 0): Place => ({ x, y, pressure: null, tilt: null });

function led(lengthPx: number): Steady {
  const steady = new Steady();
  steady.lengthPx = lengthPx;
  steady.begin(at(0));
  return steady;
}

describe('a steady stroke', () => {
  it('is at the pointer without a string', () => {
    const steady = led(0);
    expect(steady.follow([at(1), at(2, 3)])).toEqual([at(1), at(2, 3)]);
    expect(steady.stretch).toBeNull();
  });

  it('begins when the string is taut, and follows at its length', () => {
    const steady = led(20);
    expect(steady.follow([at(5), at(0, 19), at(20)])).toEqual([]);
    expect(steady.follow([at(30)])).toEqual([at(10)]);
    expect(steady.stretch).toEqual([at(10), at(30)]);
    expect(steady.follow([at(25)])).toEqual([]); // slack: it does not turn back
  });

  it('smooths a trembling hand', () => {
    const wave = (n: number): Place => at(2 * n, n % 2 === 0 ? 5 : -5);
    const heights = (lengthPx: number): number[] => {
      const steady = led(lengthPx);
      const places = Array.from({ length: 100 }, (_, n) => wave(n));
      return steady
        .follow(places)
        .slice(-50)
        .map(({ y }) => y);
    };
    expect(Math.max(...heights(0))).toBe(5);
    expect(Math.max(...heights(50).map(Math.abs))).toBeLessThan(1);
  });
});
