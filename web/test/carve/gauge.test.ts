// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Gauge } from '../../src/carve/gauge';

/** Updates every 8 ms; returns the forces that are shown, N. `forceAt`: felt then; null: no answer. */
function shown(gauge: Gauge, fromMs: number, toMs: number, forceAt: (ms: number) => number | null) {
  const all: number[] = [];
  for (let ms = fromMs; ms < toMs; ms += 8) {
    const forceN = forceAt(ms);
    if (forceN !== null) gauge.feel(forceN, ms);
    gauge.update(10, ms);
    all.push(gauge.shown.value.forceN);
  }
  return all;
}

describe('the gauge of force', () => {
  it('shows no teeth of zeros where a mouse rests between its moves', () => {
    const gauge = new Gauge();
    // One answer in eight has the force of a move, the others that of a rest.
    const mouse = (ms: number): number => (ms % 64 === 0 ? 6 : 0);
    shown(gauge, 0, 800, mouse);
    const steady = shown(gauge, 800, 1600, mouse);
    expect(Math.min(...steady)).toBeGreaterThan(5.5);
    expect(Math.max(...steady)).toBeLessThanOrEqual(6);
    expect(gauge.shown.value.share).toBeCloseTo(0.6, 1);
  });

  it('rises and falls with its time constant', () => {
    const gauge = new Gauge();
    shown(gauge, 0, 400, () => 0);
    const rising = shown(gauge, 400, 520, () => 5);
    expect(rising.at(-1)!).toBeGreaterThan(5 * (1 - Math.exp(-0.7)));
    expect(rising.at(-1)!).toBeLessThan(5 * (1 - Math.exp(-1.3)));
    shown(gauge, 520, 2000, () => 5);
    const falling = shown(gauge, 2000, 2130, () => 0);
    expect(Math.min(...falling)).toBeGreaterThan(4.5); // it is held
    expect(shown(gauge, 2130, 3200, () => null).at(-1)).toBe(0);
  });

  it('changes its figure seldom, and tells devices the force at once', () => {
    const gauge = new Gauge();
    const figures = new Set<number>();
    for (let ms = 0; ms < 600; ms += 8) {
      gauge.feel(ms / 100, ms);
      gauge.update(10, ms);
      figures.add(gauge.figureN.value);
      expect(gauge.forceN).toBe(ms / 100);
    }
    expect(figures.size).toBeLessThan(6);
    expect(figures.size).toBeGreaterThan(2);
  });
});
