// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { ForceCurve } from '../src/model/force_curve';
import { cutCurveOf, spanAt } from '../src/model/cut_curve';
import { CutControl } from '../src/ui/programs/cut_control';
import type { ProgramInfo } from '../src/wire/types';

const FORCES: ForceCurve = {
  first: [1, 3, 4],
  last: [2, 3, 9],
  minN: [0, 1, 2],
  meanN: [1, 2, 3],
  maxN: [5, 6, 7],
  endS: [2, 2, 4.5],
  removedMm3: [100, 0, 250],
  motions: [2, 1, 6],
  peaks: [{ tipMm: [1, 2, 3], forceN: [7, 0, 0], torqueNmm: [0, 4, 0] }],
};

describe('force and removal along a program', () => {
  it('are of the time since the span before; one without time is left out', () => {
    const curve = cutCurveOf(FORCES);
    expect(curve.timesS).toEqual([0, 2, 4.5]);
    expect(curve.forcesN).toEqual([5, 5, 7]);
    expect(curve.removals).toEqual([3, 3, 6]); // 50 and 100 mm³/s
    expect([0, 1, 2, 2.1, 4.5, 5, -1].map((timeS) => spanAt(curve, timeS))).toEqual([
      1, 1, 1, 2, 2, -1, -1,
    ]);
  });
});

describe('the plot of the selected program', () => {
  const program = (motions_done: number): ProgramInfo =>
    ({
      ...{ id: 3, participant: 7, motions_done, elapsed_s: 1, programmed_s: 9 },
      state: 'running',
    }) as ProgramInfo;
  let asked: number[];
  let control: CutControl;

  beforeEach(() => {
    vi.useFakeTimers();
    asked = [];
    control = new CutControl(
      (participant) => {
        asked.push(participant);
        return Promise.resolve(asked.length === 1 ? null : FORCES);
      },
      () => null,
      () => null,
      () => Promise.resolve({ CutPlot: () => null }),
    );
    control.select(3);
  });
  afterEach(() => vi.useRealTimers());

  async function update(motions: number, afterMs: number): Promise<void> {
    await vi.advanceTimersByTimeAsync(afterMs);
    control.update(program(motions));
    await vi.advanceTimersByTimeAsync(0);
  }

  it('is asked for when the program has moved, at most every 2 s, and shown once there is one', async () => {
    await update(0, 0);
    expect(asked).toEqual([]);
    expect(control.nowS.value).toBeNull();
    await update(10, 100);
    expect(asked).toEqual([7]);
    expect(control.curve.value).toBeNull(); // nothing yet
    expect(control.nowS.value).toBe(1);
    await update(20, 100);
    expect(asked).toHaveLength(1);
    await update(20, 2000);
    expect(asked).toHaveLength(2);
    const { value: curve } = control.curve;
    expect(curve).toEqual(cutCurveOf(FORCES));
    expect(control.peaks.value).toEqual(FORCES.peaks);
    expect(control.plot.value).not.toBeNull();
    expect(control.totalS.value).toBe(9);
    await update(20, 5000); // it has not moved
    expect(control.curve.value).toBe(curve);
    control.select(4);
    expect(control.curve.value).toBeNull();
    expect(control.peaks.value).toEqual([]);
    await update(30, 5000); // of another program
    expect(asked).toHaveLength(2);
  });
});
