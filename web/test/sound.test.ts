// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Participants } from '../src/model/participants';
import { nearestCut, soundOf } from '../src/model/sound';
import type { Cut } from '../src/model/sound';
import type { ToolState, Vec3 } from '../src/wire/types';

const CUT: Cut = { spindleRpm: 18000, teeth: 3, forceN: 12, removedMm3PerS: 80 };

describe('sound of a cut', () => {
  it('has the frequency at which the teeth pass', () => {
    expect(soundOf(CUT).toneHz).toBe(900);
    expect(soundOf({ ...CUT, spindleRpm: 100 }).toneHz).toBe(60); // audible
    expect(soundOf({ ...CUT, spindleRpm: 1e6 }).toneHz).toBe(4000);
  });

  it('grows with force and with removal rate, and is bounded', () => {
    const levels = [0, 1, 10, 100, 1e9].map((x) => soundOf({ ...CUT, forceN: x }));
    const rates = [0, 1, 10, 100, 1e9].map((x) => soundOf({ ...CUT, removedMm3PerS: x }));
    for (const series of [levels, rates]) {
      for (let i = 1; i < series.length; ++i) {
        expect(series[i]!.noiseGain).toBeGreaterThan(series[i - 1]!.noiseGain);
        expect(series[i]!.toneGain).toBeGreaterThan(series[i - 1]!.toneGain);
      }
      expect(series.at(-1)!.noiseGain + series.at(-1)!.toneGain).toBeLessThan(0.4);
    }
  });

  it('is the tone of a free spindle without a cut, and silence without a tool', () => {
    const free = soundOf({ ...CUT, forceN: 0, removedMm3PerS: 0 });
    expect(free.noiseGain).toBe(0);
    expect(free.toneGain).toBeGreaterThan(0);
    expect(soundOf({ ...CUT, removedMm3PerS: 0 })).toEqual(free); // contact
    const silence = soundOf(null);
    expect([silence.toneGain, silence.noiseGain]).toEqual([0, 0]);
  });
});

function tool(participant: number, tip_mm: Vec3, force: number): ToolState {
  return {
    participant,
    tool_id: 1,
    tip_mm,
    axis: [0, 0, 1],
    status: 1,
    force_n: [0, force, 0],
    torque_nmm: [0, 0, 0],
    removed_rate_mm3_per_s: 7,
    felt_share: 0,
  };
}

describe('nearest cut', () => {
  const participants = new Participants();
  participants.setList([
    { participant: 1, name: 'Ada', kind: 'agent', color: '#c2410c' },
    { participant: 2, name: 'Linus', kind: 'agent', color: '#0f766e' },
  ]);
  participants.applyTools([tool(1, [0, 0, 0], 3), tool(2, [50, 0, 0], 5)], 100);
  const carvers = participants.carvers();

  it('is that of the tool nearest to the point, with the spindle of the scene', () => {
    const force = { spindle_rpm: 9000, teeth: 4 };
    expect(nearestCut(carvers, [-20, 0, 90], force, 150)).toEqual({
      spindleRpm: 9000,
      teeth: 4,
      forceN: 3,
      removedMm3PerS: 7,
    });
    expect(nearestCut(carvers, [60, 0, 90], undefined, 150)?.forceN).toBe(5);
    expect(nearestCut(carvers, [60, 0, 90], undefined, 150)?.spindleRpm).toBe(12000);
  });

  it('is none without a recent state of a tool', () => {
    expect(nearestCut(carvers, [0, 0, 0], undefined, 3200)).toBeNull();
    expect(nearestCut([], [0, 0, 0], undefined, 150)).toBeNull();
  });
});
