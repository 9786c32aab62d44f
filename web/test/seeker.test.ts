// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from 'vitest';
import { Seeker } from '../src/model/seeker';
import type { PastPlace, Seek, StateMessage } from '../src/wire/types';

function state(at?: Partial<PastPlace>): StateMessage {
  const place = { record: 0, time_ms: 0, rate: 0, ...at };
  return {
    type: 'state',
    motions: 1,
    removed_volume_mm3: 1,
    state_hash: '1',
    settled: true,
    ...(at ? { at: place } : {}),
  };
}

describe('seeker', () => {
  let sent: Seek[];
  let seeker: Seeker;
  let live: StateMessage;
  beforeEach(() => {
    sent = [];
    live = state();
    seeker = new Seeker((seek) => sent.push(seek));
  });

  it('has one request in flight, then sends the latest of those that waited', () => {
    for (let record = 1; record <= 50; record += 1)
      seeker.ask({ at: record, rate: 0 }, live, 1000 + record);
    expect(sent).toEqual([{ type: 'seek', at: 1 }]);
    seeker.tick(state({ record: 1 }), 1200);
    expect(sent).toEqual([
      { type: 'seek', at: 1 },
      { type: 'seek', at: 50 },
    ]);
    expect(seeker.wish).toEqual({ at: 50, rate: 0 });
    seeker.tick(state({ record: 50 }), 1300);
    expect(seeker.wish).toBeNull();
    expect(seeker.looksBack).toBe(true);
    expect(sent).toHaveLength(2);
  });

  it('takes only the state that was asked for as the answer', () => {
    seeker.ask({ at: 9, rate: 2 }, live, 0);
    const others = [live, state(), state({ record: 8, rate: 2 }), state({ record: 9 })];
    for (const other of others) {
      seeker.tick(other, 100);
      expect(seeker.wish).not.toBeNull();
    }
    seeker.tick(state({ record: 12, rate: 2 }), 100);
    expect(seeker.wish).toBeNull();
    seeker.ask({ at: 'here', rate: 0 }, state({ record: 20, rate: 2 }), 300);
    expect(sent.at(-1)).toEqual({ type: 'seek' });
    seeker.tick(state({ record: 21, rate: 2 }), 310);
    expect(seeker.wish).not.toBeNull();
    seeker.tick(state({ record: 22 }), 320);
    expect(seeker.wish).toBeNull();
  });

  it('does not take the state that was there before for the answer', () => {
    const before = state({ record: 5 });
    seeker.ask({ at: 5, rate: 0 }, before, 0);
    seeker.tick(before, 100);
    expect(seeker.wish).not.toBeNull();
    seeker.tick(state({ record: 5 }), 200);
    expect(seeker.wish).toBeNull();
  });

  it('sends a newer request after a second without an answer', () => {
    seeker.ask({ at: 1, rate: 0 }, live, 0);
    seeker.ask({ at: 2, rate: 0 }, live, 900);
    expect(sent).toHaveLength(1);
    seeker.tick(live, 1100);
    expect(sent).toHaveLength(2);
  });

  it('never sends more than the server allows', () => {
    for (let ms = 0; ms < 1000; ms += 5) {
      seeker.ask({ at: ms, rate: 0 }, live, ms);
      seeker.tick(state({ record: sent.at(-1)?.at as number }), ms);
    }
    expect(sent.length).toBeGreaterThan(10);
    expect(sent.length).toBeLessThanOrEqual(20);
  });

  it('returns to the present, and stays there', () => {
    seeker.ask({ at: 3, rate: 0 }, live, 0);
    seeker.tick(state({ record: 3 }), 100);
    seeker.ask({ at: 'live', rate: 0 }, state({ record: 3 }), 200);
    expect(seeker.looksBack).toBe(false);
    for (const next of [null, state(), state()]) seeker.tick(next, 300);
    expect(seeker.wish).toBeNull();
    expect(sent.map(({ at }) => at)).toEqual([3, 'live']);
  });

  it('repeats its position, or the unanswered request, after a lost connection', () => {
    seeker.ask({ at: 3, rate: 0 }, live, 0);
    seeker.tick(state({ record: 3 }), 100);
    seeker.lost();
    seeker.tick(null, 200); // joined again
    seeker.tick(state(), 300);
    expect(sent.map(({ at }) => at)).toEqual([3, 3]);
    seeker.lost();
    seeker.tick(state(), 400);
    expect(sent.map(({ at }) => at)).toEqual([3, 3, 3]);
  });

  it('stays in the present if the server rejects the first request', () => {
    seeker.ask({ at: 3, rate: 0 }, live, 0);
    seeker.rejected();
    seeker.tick(state(), 100);
    expect(seeker.looksBack).toBe(false);
    expect(sent).toHaveLength(1);
  });
});
