// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Records } from '../src/ui/timeline/records';
import type { StateMessage } from '../src/wire/types';
import { turn } from './support/turn';

type Json = Record<string, unknown>;

function stroke(id: number, last: number, undone = false): Json {
  const times = { begin_ms: 1, end_ms: 2, motions: 3 };
  return { id, last, participant: 1, tool: 1, undone, ...times };
}

function state(motions: number, hash: string, at?: StateMessage['at']): StateMessage {
  const plain = { motions, removed_volume_mm3: motions, state_hash: hash, settled: true };
  return { type: 'state', ...plain, ...(at ? { at } : {}) };
}

describe('the records of the timeline', () => {
  let asked: string[];
  let strokes: Json[];
  let records: Records;
  const failures: unknown[] = [];

  beforeEach(() => {
    asked = [];
    strokes = [stroke(1, 10), stroke(11, 20)];
    vi.stubGlobal('fetch', (path: string) => {
      asked.push(path.replace('/v1/sessions/demo/', ''));
      const since = Number(/since=(\d+)/.exec(path)?.[1] ?? 0);
      const found = strokes.filter(({ id }) => Number(id) >= since);
      const body = path.includes('versions') ? { versions: [] } : { strokes: found };
      return Promise.resolve({ ok: true, json: () => Promise.resolve(body) });
    });
    records = new Records('demo', (problem) => failures.push(problem));
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    expect(failures).toEqual([]);
  });

  async function tick(nowMs: number, now: StateMessage): Promise<void> {
    records.tick(nowMs, now, false);
    await turn();
  }

  it('asks for all strokes once, then from the open one on', async () => {
    await tick(0, state(20, 'a'));
    strokes.push(stroke(21, 30));
    for (let n = 1; n <= 20; n += 1) await tick(2000 * n, state(20 + n, `b${n}`));
    const since = asked.filter((path) => path.startsWith('strokes'));
    expect(since.slice(0, 3)).toEqual(['strokes?since=0', 'strokes?since=11', 'strokes?since=21']);
    expect(since.filter((path) => path === 'strokes?since=0')).toHaveLength(1);
    expect(records.strokes).toHaveLength(3);
    expect(records.end).toBe(30);
    // Versions of others, every 15 s of these 40.
    expect(asked.filter((path) => path === 'versions')).toHaveLength(3);
  });

  it('asks for all of them when one may have been undone', async () => {
    await tick(0, state(20, 'a'));
    strokes[0] = stroke(1, 10, true);
    await tick(2000, state(20, 'b'));
    expect(asked.filter((path) => path === 'strokes?since=0')).toHaveLength(2);
    expect(records.strokes[0]!.undone).toBe(true);
  });

  it('asks for all of them every 15 s in the past, and back in the present', async () => {
    const past = { record: 5, time_ms: 0, rate: 0 };
    await tick(0, state(5, 'p', past));
    await tick(8000, state(5, 'p', past));
    expect(asked.filter((path) => path === 'strokes?since=0')).toHaveLength(1);
    await tick(16_000, state(5, 'p', past));
    expect(asked.filter((path) => path === 'strokes?since=0')).toHaveLength(2);
    await tick(18_000, state(20, 'a'));
    expect(asked.filter((path) => path === 'strokes?since=0')).toHaveLength(3);
  });
});
