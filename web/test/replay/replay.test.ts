// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { SPAN_RECORDS, spansOf } from '../../src/link/replay';
import type { CarvingWorker } from '../../src/local/carving_worker';
import type { FromWorker, ToWorker } from '../../src/local/messages';
import { SessionModel } from '../../src/model/session';
import { compared } from '../../src/replay/check';
import { LocalPast, RECORDS_MAX } from '../../src/replay/local_past';
import type { Picture } from '../../src/ui/picture';
import type { Seek, StateMessage, ToolState } from '../../src/wire/types';
import { turn } from '../support/turn';

describe('the spans of a journal', () => {
  it('begin where everybody asks for them, so that caches have them', () => {
    const N = SPAN_RECORDS;
    expect(spansOf(0, 10)).toEqual([{ first: 1, last: 10 }]);
    expect(spansOf(0, 2 * N + 3)).toEqual([
      { first: 1, last: N },
      { first: N + 1, last: 2 * N },
      { first: 2 * N + 1, last: 2 * N + 3 },
    ]);
    expect(spansOf(N - 5, N + 5)).toEqual([
      { first: 1, last: N },
      { first: N + 1, last: N + 5 },
    ]);
    expect(spansOf(7, 7)).toEqual([]);
  });
});

describe('a replay', () => {
  const server = { journal: 'j', record: 20, state_hash: 'abc' };
  it('is verified by the hash after the record of the server only', () => {
    expect(compared(server, { record: 20, hash: 'abc' }).is).toBe('verified');
    const other = compared(server, { record: 20, hash: 'abd' });
    expect(other).toMatchObject({ is: 'different', serverHash: 'abc' });
    expect(compared(server, { record: 19, hash: 'abc' }).is).toBe('different');
  });
});

const LIVE: StateMessage = {
  type: 'state',
  motions: 100,
  removed_volume_mm3: 5,
  state_hash: 'live',
  settled: true,
};

describe('the past in the page', () => {
  let record: number;
  let model: SessionModel;
  let posted: ToWorker[];
  let opened: ToWorker[];
  let asked: string[];
  let toServer: Seek[];
  let hear: (message: FromWorker) => void;
  let past: LocalPast;
  const local = { open: vi.fn(), close: vi.fn(), cover: vi.fn() };

  beforeEach(() => {
    [record, posted, opened, asked, toServer] = [100, [], [], [], []];
    vi.clearAllMocks();
    vi.spyOn(console, 'warn').mockImplementation(() => undefined);
    vi.stubGlobal('fetch', (path: string) => {
      asked.push(path.replace('/v1/sessions/block/', ''));
      const body = { journal: 'j', record, state_hash: 'live' };
      return Promise.resolve({
        ok: true,
        json: () => Promise.resolve(body),
        arrayBuffer: () => Promise.resolve(new ArrayBuffer(1)),
      });
    });
    model = new SessionModel();
    model.apply({ type: 'welcome', grid: { origin_mm: [0, 0, 0] }, participants: [] } as never);
    model.apply(LIVE);
    const viewer = { local, touchAll: vi.fn() };
    const host = {
      session: 'block',
      model,
      picture: { viewer } as unknown as Picture,
      seek: (seek: Seek) => toServer.push(seek),
      isCarving: () => false,
    };
    past = new LocalPast(host, (heard) => {
      hear = heard;
      const worker = {
        open: (first: ToWorker) => opened.push(first),
        post: (message: ToWorker) => posted.push(message),
        end: vi.fn(),
      };
      return worker as unknown as CarvingWorker;
    });
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  const reach = (carved: number, hash: string | null, rate = 0, tools: ToolState[] = []): void =>
    reachWith([{ x: carved, y: 0 }], carved, hash, rate, tools);
  const reachWith = (
    tiles: { x: number; y: number }[],
    carved: number,
    hash: string | null,
    rate = 0,
    tools: ToolState[] = [],
  ): void =>
    hear({
      type: 'carved',
      progress: { carved, machining_s: 0, time_s: 0, next_s: null, removed_mm3: 1, line: 0, tools },
      tiles: tiles as never,
      hash,
      rate,
      carvingMs: 0,
    });
  const lookBack = async (at: number): Promise<void> => {
    past.seek({ type: 'seek', at });
    await turn();
    hear({ type: 'opened', about: {} as never, path: null });
    reach(at, `state ${at}`);
  };

  it('asks for files once, and answers seeks as the server does', async () => {
    await lookBack(40);
    expect(asked).toEqual(['replay', 'origin?journal=j', 'records?journal=j&first=1&last=100']);
    expect(opened).toMatchObject([{ type: 'journal', to: 40, isSilent: false }]);
    expect(past.isShown).toBe(true);
    expect(model.state).toMatchObject({ state_hash: 'state 40', at: { record: 40, rate: 0 } });
    past.seek({ type: 'seek', at: 60 });
    await turn();
    expect(posted.at(-1)).toEqual({ type: 'seek', motion: 60 }); // a stop would end it too early
    reach(60, 'state 60');
    expect(model.state?.at?.record).toBe(60);
    past.seek({ type: 'seek', rate: 8 });
    expect(posted.at(-1)).toEqual({ type: 'play', rate: 8 });
    reach(70, null, 8);
    expect(model.state).toMatchObject({ settled: false, at: { record: 70, rate: 8 } });
    expect(asked).toHaveLength(3);
    expect(toServer).toEqual([]);
  });

  it('displays tools while it plays, not at a place that was sought', async () => {
    await lookBack(40);
    const tool = {
      participant: 3,
      tool_id: 1,
      status: 0,
      tip_mm: [1, 2, 3],
      axis: [0, 0, 1],
      force_n: [0, 0, 0],
      torque_nmm: [0, 0, 0],
      removed_rate_mm3_per_s: 0,
    } as unknown as ToolState;
    const isDisplayed = (): boolean => model.participants.get(3)?.track.empty === false;
    model.participants.looksBack = true;
    past.seek({ type: 'seek', rate: 8 });
    reach(50, null, 8, [tool]);
    expect(isDisplayed()).toBe(true);
    past.seek({ type: 'seek', at: 20 });
    await turn();
    reach(20, 'state 20', 0, [tool]);
    expect(isDisplayed()).toBe(false);
  });

  it('returns to the present, of which it has kept the newest state', async () => {
    await lookBack(40);
    past.keep({ ...LIVE, motions: 120 });
    past.seek({ type: 'seek', at: 'live' });
    expect(past.isShown).toBe(false);
    expect(local.close).toHaveBeenCalled();
    expect(model.state).toEqual({ ...LIVE, motions: 120 });
    reach(41, 'state 41'); // the worker's late message
    expect(model.state?.motions).toBe(120);
    local.cover.mockClear();
    past.seek({ type: 'seek', at: 41 });
    await turn();
    expect((local.cover.mock.calls[0]![0] as unknown[]).length).toBe(2); // all tiles again
  });

  it('states no record before it has a tile to display, so that the present is not lost', async () => {
    past.seek({ type: 'seek', at: 1 });
    await turn();
    hear({ type: 'opened', about: {} as never, path: null });
    reachWith([], 1, 'state 1');
    expect(model.state).toEqual(LIVE);
    past.seek({ type: 'seek', at: 'live' });
    past.seek({ type: 'seek', at: 'live' }); // the playback asks again
    expect([past.isShown, model.state]).toEqual([false, LIVE]);
  });

  it('gets records that have come since before it goes there', async () => {
    await lookBack(40);
    record = 130;
    past.seek({ type: 'seek', at: 125 });
    await turn();
    expect(asked.slice(3)).toEqual(['replay', 'records?journal=j&first=1&last=130']);
    expect(posted.slice(-2).map(({ type }) => type)).toEqual(['records', 'seek']);
  });

  it('leaves it to the server where the worker fails, and journals that are too long', async () => {
    await lookBack(40);
    hear({ type: 'failed', reason: 'out of memory' });
    expect(toServer).toMatchObject([{ at: 40 }]);
    expect(past.isShown).toBe(false);
    past.seek({ type: 'seek', at: 50 });
    expect(toServer.at(-1)).toMatchObject({ at: 50 });
    past.seek({ type: 'seek', at: 'live' });
    expect(toServer.at(-1)).toMatchObject({ at: 'live' });
  });

  it('leaves journals that are too long to the server', async () => {
    record = RECORDS_MAX + 1;
    past.seek({ type: 'seek', at: 50 });
    await turn();
    expect(opened).toEqual([]);
    expect(toServer).toMatchObject([{ at: 50 }]);
  });
});
