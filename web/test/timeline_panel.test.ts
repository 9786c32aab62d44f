// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Bookmarks } from '../src/ui/timeline/bookmarks';
import { Records } from '../src/ui/timeline/records';
import type { StateMessage } from '../src/wire/types';
import type { FakeElement } from './support/fake_dom';
import { stubPage } from './support/fake_dom';
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
    records = new Records('demo', vi.fn(), (problem) => failures.push(problem));
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    expect(failures).toEqual([]);
  });

  async function tick(nowMs: number, now: StateMessage): Promise<void> {
    records.tick(nowMs, now, false);
    await turn();
  }

  it('asks for all strokes once, then for the open one and what follows', async () => {
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

describe('the versions of the timeline', () => {
  const HALF = { name: 'Half done', record: 12, time_ms: 0, author: 'Ada', may_change: true };

  function open(): { calls: unknown[][]; element: FakeElement; bookmarks: Bookmarks } {
    stubPage();
    const calls: unknown[][] = [];
    const call =
      (name: string) =>
      (...values: unknown[]): void => {
        calls.push([name, ...values]);
      };
    const names = ['go', 'name', 'rename', 'remove', 'branch'] as const;
    const actions = Object.fromEntries(names.map((name) => [name, call(name)]));
    const bookmarks = new Bookmarks(
      actions as unknown as ConstructorParameters<typeof Bookmarks>[0],
      () => 'demo-12',
    );
    bookmarks.allow(true, true);
    bookmarks.show([HALF]);
    return { calls, element: bookmarks.element as unknown as FakeElement, bookmarks };
  }

  afterEach(() => vi.unstubAllGlobals());

  const button = (element: FakeElement, label: string): FakeElement =>
    element.all('timeline-action').find(({ textContent }) => textContent === label)!;

  it('can be renamed and deleted once one is chosen', () => {
    const { calls, element } = open();
    expect(button(element, 'Rename').disabled).toBe(true);
    expect(button(element, 'Delete').disabled).toBe(true);
    const list = element.all('timeline-versions')[0]!;
    list.value = 'Half done';
    list.dispatch('change');
    expect(button(element, 'Rename').disabled).toBe(false);
    button(element, 'Rename').click();
    const input = element.all('timeline-input')[0]!;
    expect(input.value).toBe('Half done');
    input.value = ' Roughed ';
    element.all('timeline-form')[0]!.dispatch('submit');
    button(element, 'Delete').click();
    expect(calls).toEqual([
      ['go', 12],
      ['rename', 'Half done', 'Roughed'],
      ['remove', 'Half done'],
    ]);
  });

  it('of others can only be gone to', () => {
    const { calls, element, bookmarks } = open();
    bookmarks.show([{ ...HALF, may_change: false }]);
    const list = element.all('timeline-versions')[0]!;
    list.value = 'Half done';
    list.dispatch('change');
    expect(calls).toEqual([['go', 12]]);
    expect(button(element, 'Rename').disabled).toBe(true);
    expect(button(element, 'Delete').disabled).toBe(true);
  });

  it('cannot be changed without the right', () => {
    const { element, bookmarks } = open();
    bookmarks.allow(false, false);
    for (const label of ['Rename', 'Delete', 'Save a version', 'Branch from here'])
      expect(button(element, label).hidden).toBe(true);
  });
});
