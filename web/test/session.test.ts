// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { SessionModel, stockBounds } from '../src/model/session';
import type { Header, ToolState, Welcome } from '../src/wire/types';

const welcome: Welcome = {
  type: 'welcome',
  session: 'demo',
  participant: 9,
  epoch: 1,
  color: '#888888',
  pitch_mm: 0.5,
  pivot_mm: 60,
  stock: { shape: 'box', min_mm: [0, 0, 0], max_mm: [1, 1, 1] },
  tools: [{ id: 4, shape: 'ball', diameter_mm: 6, length_mm: 30 }],
  participants: [{ participant: 1, name: 'Ada', color: '#112233', tool: 4, kind: 'agent' }],
  grid: { origin_mm: [0, 0, 0], columns: [2, 2], tile: 32 },
};

function header(timeUs: number): Header {
  return { type: 4, flags: 0, epoch: 1, sequence: 1n, time_us: BigInt(timeUs) };
}

const cutting: ToolState = {
  participant: 1,
  tool_id: 4,
  tip_mm: [1, 2, 3],
  axis: [0, 0, 1],
  status: 1,
  force_n: [0, 3, 4],
  torque_nmm: [1, 0, 0],
  removed_rate_mm3_per_s: 2,
  felt_share: 0,
};

describe('session', () => {
  it('knows the tools of the scene and maps tool states to the local clock', () => {
    const model = new SessionModel();
    model.apply(welcome);
    model.applyTools(header(77_000_000), [cutting], 500);
    expect(model.tool(4)?.shape).toBe('ball');
    expect(model.tool(5)).toBeUndefined();
    const ada = model.participants.get(1);
    expect(ada?.forces.latest.forceN).toBe(5);
    expect(ada?.seenMs).toBeCloseTo(500, 9); // not the server's 77 s
  });

  it('resets state, snapshot, poses and clock with each welcome', () => {
    const model = new SessionModel();
    model.apply(welcome);
    model.tiles.finishSnapshot();
    model.apply({
      type: 'state',
      motions: 5,
      removed_volume_mm3: 1,
      state_hash: 'abc',
      settled: true,
    });
    model.applyTools(header(77_000_000), [cutting], 500);
    model.apply({ ...welcome, epoch: 2 });
    expect(model.state).toBeNull();
    expect(model.tiles.complete).toBe(false);
    expect(model.participants.get(1)?.track.empty).toBe(true);
    model.applyTools(header(1_000_000), [cutting], 600); // the new server's clock started again
    expect(model.participants.get(1)?.seenMs).toBeCloseTo(600, 9);
  });

  it('keeps the last problem and counts all of them', () => {
    const model = new SessionModel();
    model.apply({ type: 'error', code: 'bad_frame', reason: 'too short', fatal: false });
    expect(model.problems).toBe(1);
    expect(model.problem).toBe('too short (bad_frame)');
  });

  it('returns the age of the picture only after the first pong', () => {
    const model = new SessionModel();
    expect(model.stalenessMs(0)).toBeNaN();
    model.applyTools(header(1_000_000), [], 100);
    expect(model.stalenessMs(150)).toBeNaN();
    model.clock.pong(90, 110, 1_000_000n);
    expect(model.stalenessMs(150)).toBeCloseTo(50, 6);
  });
});

describe('stock bounds', () => {
  it('enclose a cylinder', () => {
    expect(
      stockBounds({
        shape: 'cylinder',
        center_mm: [1, 2],
        radius_mm: 3,
        min_z_mm: -4,
        max_z_mm: 5,
      }),
    ).toEqual({ min: [-2, -1, -4], max: [4, 5, 5] });
  });
});
