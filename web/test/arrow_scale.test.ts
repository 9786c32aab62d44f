// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { ArrowScale, roundUp125 } from '../src/model/arrow_scale';
import { ForceHistory } from '../src/model/forces';

it('a history drops samples older than its window, even if no new ones arrive', () => {
  const history = new ForceHistory(10);
  for (let s = 0; s < 5; ++s) history.push(s, s, 2 * s);
  history.forget(12.5);
  expect([...history.series()[0]]).toEqual([3, 4]);
  history.forget(100);
  expect(history.count).toBe(0);
  expect(history.latest).toEqual({ forceN: 0, torqueNmm: 0 });
  history.push(200, 1, 1);
  expect(history.count).toBe(1);
});

function participant(forceN: number, torqueNmm: number): { forces: ForceHistory } {
  const forces = new ForceHistory(10);
  for (let i = 0; i < 100; ++i) forces.push(i / 10, forceN, torqueNmm);
  return { forces };
}

describe('arrow scale', () => {
  it('fits the participant with the largest typical force and torque', () => {
    const scale = new ArrowScale();
    scale.update([participant(2, 3), participant(1, 40)], 0);
    expect(scale.forceFullN).toBe(5);
    expect(scale.torqueFullNmm).toBe(100);
  });

  it('has a minimum', () => {
    const scale = new ArrowScale();
    scale.update([participant(0, 0)], 0);
    expect(scale.forceFullN).toBe(0.1);
    expect(scale.torqueFullNmm).toBe(1);
  });

  it('is updated at most every 250 ms', () => {
    const scale = new ArrowScale();
    scale.update([participant(2, 3)], 0);
    scale.update([participant(20, 3)], 249);
    expect(scale.forceFullN).toBe(5);
    scale.update([participant(20, 3)], 250);
    expect(scale.forceFullN).toBe(50);
  });
});

describe('arrow scale rounding', () => {
  it.each([
    [0, 1],
    [0.03, 0.05],
    [0.1, 0.1],
    [1, 1],
    [1.01, 2],
    [2.5, 5],
    [7, 10],
    [100, 100],
    [101, 200],
    [Number.NaN, 1],
  ])('rounds %d up to %d', (value, expected) => expect(roundUp125(value)).toBeCloseTo(expected, 9));
});
