// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { FromWorker, ToWorker } from '../../src/local/messages';
import { SessionCheck } from '../../src/replay/check';
import type { Verdict } from '../../src/replay/check';
import { firstDifference } from '../../src/replay/first_difference';
import type { ReplayWorker } from '../../src/replay/replayer';

const hashOf = (record: number): string => `state ${record}`;

/** A worker whose block differs from record `wrongFrom` on. */
class FakeReplay implements ReplayWorker {
  static made: FakeReplay[] = [];
  static wrongFrom = Infinity;
  readonly posted: ToWorker[] = [];
  isEnded = false;

  constructor(private readonly heard: (message: FromWorker) => void) {
    FakeReplay.made.push(this);
  }
  open(first: ToWorker & { type: 'open' | 'journal' }): void {
    this.posted.push(first);
    this.reach_(first.type === 'journal' ? first.to : 0);
  }
  post(message: ToWorker): void {
    this.posted.push(message);
    if (message.type === 'carve') this.reach_(message.to);
    if (message.type === 'seek') this.reach_(message.motion);
  }
  end(): void {
    this.isEnded = true;
  }
  private reach_(carved: number): void {
    const hash = carved >= FakeReplay.wrongFrom ? `other ${carved}` : hashOf(carved);
    const progress = { carved: Math.floor(carved / 2) } as never;
    const base = { type: 'carved' as const, tiles: [], rate: 0, carvingMs: 0 };
    queueMicrotask(() => {
      this.heard({ ...base, progress, hash: null });
      this.heard({ ...base, progress: { carved } as never, hash });
    });
  }
}

/** Stored of records at equal distances, at most `most`, as the server answers. */
function storedOf(every: number, most: number) {
  return (first: number, last: number) => {
    const all: { record: number; hash: string }[] = [];
    for (let record = every; record <= last; record += every)
      if (record >= first) all.push({ record, hash: hashOf(record) });
    const count = Math.min(most, all.length);
    return Array.from({ length: count }, (_, n) => {
      return all[Math.floor(((n + 1) * all.length) / count) - 1]!;
    });
  };
}

describe('the first difference', () => {
  const last = { record: 5000, hash: hashOf(5000) };
  const find = (wrongFrom: number, isServersReplayToo = false, every = 40) => {
    const own = (record: number) =>
      Promise.resolve({ record, hash: record >= wrongFrom ? 'other' : hashOf(record) });
    const stored = storedOf(every, 7);
    return firstDifference(
      {
        stored: (from, to) => Promise.resolve(stored(from, to)),
        replayed: async (record) =>
          isServersReplayToo ? (await own(record)).hash : hashOf(record),
      },
      { carve: own, seek: own },
      last,
    );
  };

  it.each([1, 2, 39, 40, 41, 2501, 4999, 5000])('is found at record %i', async (record) => {
    expect(await find(record)).toEqual({ after: record - 1, by: record });
  });

  it('is found between two stored hashes where the server replays as the page does', async () => {
    expect(await find(2501, true)).toEqual({ after: 2480, by: 2520 });
    expect(await find(3, true)).toEqual({ after: 0, by: 40 });
  });

  it('is found without any stored hash', async () => {
    expect(await find(1234, false, 10_000)).toEqual({ after: 1233, by: 1234 });
  });

  it('is the first one, also where the states are equal again later', async () => {
    const own = (record: number) => {
      const isOther = (record >= 100 && record < 200) || record >= 4000;
      return Promise.resolve({ record, hash: isOther ? 'other' : hashOf(record) });
    };
    const stored = storedOf(40, 1000);
    const server = {
      stored: (from: number, to: number) => Promise.resolve(stored(from, to)),
      replayed: (record: number) => Promise.resolve(hashOf(record)),
    };
    const found = await firstDifference(server, { carve: own, seek: own }, last);
    expect(found).toEqual({ after: 99, by: 100 });
  });
});

describe('the check of a session', () => {
  let record: number;
  let journal: string;
  let asked: string[];
  let verdicts: Verdict[];
  let check: SessionCheck;
  const run = async (): Promise<Verdict> => {
    await check.run((verdict) => verdicts.push(verdict));
    return verdicts.at(-1)!;
  };

  beforeEach(() => {
    [record, journal, asked, verdicts] = [100, 'j', [], []];
    [FakeReplay.made, FakeReplay.wrongFrom] = [[], Infinity];
    vi.stubGlobal('fetch', (path: string) => {
      asked.push(path.replace('/v1/sessions/block/', ''));
      const at = /at=(\d+)/.exec(path);
      const then = at ? Number(at[1]) : record;
      const [, first, last] = /first=(\d+)&last=(\d+)/.exec(path) ?? [];
      const stored = storedOf(30, 9)(Number(first), Number(last));
      const hashes = stored.map(({ record: of, hash }) => ({ record: of, state_hash: hash }));
      const body = { journal, record: then, state_hash: hashOf(then), hashes };
      return Promise.resolve({
        ok: true,
        json: () => Promise.resolve(body),
        arrayBuffer: () => Promise.resolve(new ArrayBuffer(1)),
      });
    });
    check = new SessionCheck('block', (heard) => new FakeReplay(heard));
  });
  afterEach(() => vi.unstubAllGlobals());

  it('replays all records the first time, and then those behind what was verified', async () => {
    expect(await run()).toEqual({ is: 'verified', record: 100, hash: hashOf(100) });
    expect(asked).toEqual(['replay', 'records?journal=j&first=1&last=100', 'origin?journal=j']);
    expect(verdicts).toContainEqual({ is: 'running', share: 0.5 });
    record = 40_000;
    asked = [];
    expect(await run()).toEqual({ is: 'verified', record: 40_000, hash: hashOf(40_000) });
    expect(FakeReplay.made).toHaveLength(1);
    expect(FakeReplay.made[0]!.posted.slice(1).map(({ type }) => type)).toEqual([
      'records',
      'records',
      'carve',
    ]);
    expect(asked).toEqual([
      'replay',
      'records?journal=j&first=1&last=32768',
      'records?journal=j&first=32769&last=40000',
    ]);
    [record, asked] = [40_100, []];
    expect((await run()).is).toBe('verified');
    expect(asked).toEqual(['replay', 'records?journal=j&first=32769&last=40100']);
  });

  it('begins again with another journal of the session', async () => {
    await run();
    journal = 'k';
    expect((await run()).is).toBe('verified');
    expect(FakeReplay.made).toHaveLength(2);
    expect(FakeReplay.made[0]!.isEnded).toBe(true);
    expect(asked.at(-1)).toBe('origin?journal=k');
  });

  it('says at once that the states differ, and then where they part', async () => {
    await run();
    FakeReplay.wrongFrom = 77;
    record = 110;
    const different = {
      is: 'different',
      record: 110,
      hash: 'other 110',
      serverHash: hashOf(110),
    };
    expect(await run()).toEqual({ ...different, first: { after: 76, by: 77 } });
    expect(verdicts.at(-2)).toEqual({ ...different, first: null });
    expect(FakeReplay.made.every(({ isEnded }) => isEnded)).toBe(true);
    FakeReplay.wrongFrom = Infinity;
    expect((await run()).is).toBe('verified'); // from the beginning
  });

  it('says why it cannot', async () => {
    check = new SessionCheck('block', (heard) => {
      const worker = new FakeReplay(heard);
      worker.open = () => queueMicrotask(() => heard({ type: 'failed', reason: 'no memory' }));
      return worker;
    });
    expect(await run()).toEqual({ is: 'failed', reason: 'no memory' });
  });
});
