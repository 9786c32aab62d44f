// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { FromWorker, ToWorker } from '../../src/local/messages';
import { SessionCheck } from '../../src/replay/check';
import type { Verdict } from '../../src/replay/check';
import { firstDifference } from '../../src/replay/first_difference';
import type { ShownPicture } from '../../src/replay/shown_picture';
import type { TileTriangles } from '../../src/kernel/kernel';
import type { ReplayWorker } from '../../src/replay/replayer';

const hashOf = (record: number): string => `state ${record}`;

const FLAT: TileTriangles = {
  x: 0,
  y: 0,
  positions: new Float32Array([0, 0, 0, 8, 0, 0, 0, 8, 0]),
  normals: new Float32Array(9),
  index: new Uint32Array([0, 1, 2]),
  original: new Uint8Array(3),
};

/** A picture that shows the state after a record, up to `offMm` above it. */
function pictureOf(record: number, offMm = 0): ShownPicture {
  const corners = Float64Array.from([0, 0, offMm, 8, 0, offMm, 0, 8, offMm]);
  return {
    hash: hashOf(record),
    isBehind: false,
    pitchMm: 0.5,
    tiles: () => [{ x: 0, y: 0, level: 0, digest: `digest ${record}` }],
    corners: () => new Map([[0, corners]]),
  };
}

/** A worker whose block differs from record `wrongFrom` on. */
class FakeReplay implements ReplayWorker {
  static made: FakeReplay[] = [];
  static wrongFrom = Infinity;
  readonly posted: ToWorker[] = [];
  isEnded = false;
  private at_ = 0;

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
    if (message.type === 'digests')
      this.heard({ type: 'digests', tiles: [{ x: 0, y: 0, digest: `digest ${this.at_}` }] });
    if (message.type === 'mesh') this.heard({ type: 'mesh', tile: FLAT });
  }
  end(): void {
    this.isEnded = true;
  }
  private reach_(carved: number): void {
    this.at_ = carved;
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
  let picture: ShownPicture | null;
  let pauses: number;
  let paused: () => void;
  const pause = (): Promise<void> => {
    pauses += 1;
    paused();
    return Promise.resolve();
  };
  const run = async (): Promise<Verdict> => {
    await check.run((verdict) => verdicts.push(verdict));
    return verdicts.at(-1)!;
  };

  beforeEach(() => {
    [record, journal, asked, verdicts] = [100, 'j', [], []];
    [picture, pauses, paused] = [null, 0, () => undefined];
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
    check = new SessionCheck(
      'block',
      () => picture,
      (heard) => new FakeReplay(heard),
      pause,
    );
  });
  afterEach(() => vi.unstubAllGlobals());

  it('replays all records the first time, then those after the verified ones', async () => {
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
    const make = (heard: (message: FromWorker) => void) => {
      const worker = new FakeReplay(heard);
      worker.open = () => queueMicrotask(() => heard({ type: 'failed', reason: 'no memory' }));
      return worker;
    };
    check = new SessionCheck('block', () => picture, make);
    expect(await run()).toEqual({ is: 'failed', reason: 'no memory' });
  });

  it('verifies a picture that shows the state', async () => {
    picture = pictureOf(100, 0.4);
    expect(await run()).toEqual({ is: 'verified', record: 100, hash: hashOf(100) });
    expect(pauses).toBe(0);
  });

  it('does not verify a picture of another state, or another mesh', async () => {
    const wrong = { ...pictureOf(90), hash: hashOf(100) };
    for (const shown of [wrong, pictureOf(100, 0.6), { ...pictureOf(100), tiles: () => [] }]) {
      picture = shown;
      expect(await run()).toEqual({ is: 'unseen', record: 100, tiles: 1 });
      expect(verdicts.some(({ is }) => is === 'verified')).toBe(false);
    }
  });

  it('waits for a picture that is late, and verifies it when it is there', async () => {
    picture = { ...pictureOf(90), hash: null, isBehind: true };
    paused = () => {
      if (pauses === 100) picture = pictureOf(100);
    };
    expect((await run()).is).toBe('verified');
    expect(verdicts).toContainEqual({ is: 'waiting', record: 100, isBehind: true });
    expect(pauses).toBeGreaterThanOrEqual(100);
  });

  it('replays the motions carved meanwhile', async () => {
    picture = { ...pictureOf(90), hash: null };
    paused = () => {
      record = 120;
      picture = pictureOf(120);
    };
    expect(await run()).toEqual({ is: 'verified', record: 120, hash: hashOf(120) });
    expect(verdicts).toContainEqual({ is: 'waiting', record: 100, isBehind: false });
  });
});
