// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h, render } from 'preact';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { SessionSummary } from '../src/link/api';
import { SessionModel } from '../src/model/session';
import { History } from '../src/ui/history/state';
import { HistoryView } from '../src/ui/history/view';
import { Cards } from '../src/ui/lobby/cards';
import { fromFile } from '../src/ui/lobby/drafts';
import { Lobby } from '../src/ui/lobby/lobby';
import { LobbyState } from '../src/ui/lobby/lobby_state';
import { buttonOf, labelled, show } from './support/shown';
import { turn } from './support/turn';

function session(id: string, activeMs: number, motions = 1, removedVolumeMm3 = 5): SessionSummary {
  return {
    ...{ id, name: id, motions, removedVolumeMm3, participants: 0, activeMs },
    mayRename: true,
    mayClose: false,
  };
}

/** The server's answers by the end of a path; any other request fails with a reason. */
let answers: Record<string, unknown>;
let asked: string[];

beforeEach(() => {
  answers = {};
  asked = [];
  vi.stubGlobal('fetch', (path: string) => {
    asked.push(path);
    const found = Object.entries(answers).find(([part]) => path.includes(part));
    const fault = { error: { code: 'busy', reason: 'the server is busy' } };
    return Promise.resolve(
      new Response(JSON.stringify(found?.[1] ?? fault), { status: found ? 200 : 503 }),
    );
  });
});
afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

describe('the cards of the lobby', () => {
  let root: HTMLElement;

  beforeEach(() => {
    root = document.createElement('div');
  });
  const update = (...sessions: SessionSummary[]): void =>
    render(h(Cards, { sessions, actions: () => [] }), root);
  const cards = (): Element[] => [...root.querySelectorAll('.card-place')];
  const names = (): string[] => cards().map((one) => one.querySelector('strong')!.textContent);

  it('move with their elements', () => {
    update(session('b', 3), session('c', 2), session('a', 1));
    expect(names()).toEqual(['b', 'c', 'a']);
    const [, , a] = cards();
    update(session('a', 9), session('b', 3), session('c', 2));
    expect(names()).toEqual(['a', 'b', 'c']);
    expect(cards()[0]).toBe(a);
  });

  it('show a new picture after an undo, which adds no motion', () => {
    const shown = (): string => root.querySelector('img')!.src;
    update(session('a', 1));
    update(session('a', 1));
    const before = shown(); // of the block at rest
    update(session('a', 1));
    expect(shown()).toBe(before);
    update(session('a', 2, 1, 4));
    expect(shown()).not.toBe(before);
  });
});

describe('the menu of a card', () => {
  it('has what the viewer may do, and hides itself', async () => {
    answers = { '/v1/sessions': { sessions: [] } };
    const state = new LobbyState([session('owl', 1), session('cat', 2)]);
    const root = show(h(Lobby, { state }));
    const menu = labelled(root, 'More for owl').parentElement!;
    const shown = (): boolean => !menu.querySelector('ul')!.hidden;
    const words = (): (string | null)[] =>
      [...menu.querySelectorAll('li button')].map((one) => one.textContent);
    expect(words()).toEqual(['Rename…']);
    state.mayManage.value = true;
    await turn();
    expect(words()).toEqual(['Rename…', 'Duplicate']);
    expect(shown()).toBe(false);
    labelled(root, 'More for owl').click();
    await turn();
    expect(shown()).toBe(true);
    menu.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape', bubbles: true }));
    await turn();
    expect(shown()).toBe(false);
    buttonOf(menu, 'Duplicate').click();
    expect(asked.at(-1)).toBe('/v1/sessions?from=owl&name=owl%202');
    buttonOf(menu, 'Rename…').click();
    expect(state.toRename.value?.id).toBe('owl');
  });

  it('tells that a name is taken, and what else went wrong', async () => {
    const state = new LobbyState([session('owl', 1)]);
    expect(await state.rename(session('owl', 1), 'cat')).toBe('The server is busy.');
    expect(asked.at(-1)).toBe('/v1/sessions/owl?name=cat');
    vi.stubGlobal('fetch', () =>
      Promise.resolve(
        Response.json({ error: { code: 'name_taken', reason: 'no' } }, { status: 409 }),
      ),
    );
    expect(await state.rename(session('owl', 1), 'cat')).toBe('Another block has this name.');
  });
});

describe('the fault of the lobby', () => {
  it('stays when the list comes, unless it is of the list', async () => {
    vi.useFakeTimers();
    const state = new LobbyState([]);
    state.start();
    const poll = (): Promise<unknown> => vi.advanceTimersByTimeAsync(3000);
    await vi.advanceTimersByTimeAsync(0);
    expect(state.fault.value).toBe('The server is busy.'); // of the templates
    answers = { '/v1/sessions': { sessions: [] } };
    await poll();
    expect(state.fault.value).toBe('The server is busy.');
    answers = {};
    await poll();
    expect(state.fault.value).toContain('503');
    answers = { '/v1/sessions': { sessions: [] } };
    await poll();
    expect(state.fault.value).toBe('');
  });
});

describe('a program as the beginning of a block', () => {
  const derived = {
    scene: {
      stock: { shape: 'box', min_mm: [0, 0, -5], max_mm: [9, 9, 0] },
      tools: [{ id: 1, shape: 'flat', diameter_mm: 6, length_mm: 30 }],
      accuracy: { target_mm: 0.05 },
    },
    provenance: [{ tool: 1, field: 'diameter_mm', origin: 'assumed', source: '' }],
    motions: 9,
    programmed_s: 5,
    machine_s: 6,
  };
  const draftOf = (name: string) => fromFile(new File(['M30\n'], name), false);

  it('may have any name that the server reads', async () => {
    answers = { programs: derived };
    expect((await draftOf('PART.H')).program?.name).toBe('PART.H');
    expect((await draftOf('part.mpf')).name).toBe('part');
    expect((await draftOf('part.cldata')).name).toBe('part');
    await expect(draftOf('part.docx')).rejects.toThrow('whose name ends in .stl');
  });

  it('is the scene that the server derives, with its accuracy', async () => {
    answers = { programs: derived };
    const draft = await draftOf('part.ngc');
    expect(draft.targetMm).toBe(0.05);
    expect(draft.scene()).toEqual(derived.scene);
  });
});

describe('the list of strokes', () => {
  const open = async (): Promise<{ model: SessionModel; root: HTMLElement }> => {
    const model = new SessionModel();
    const root = show(h(HistoryView, { history: new History(model, 'demo', { selected: null }) }));
    root.querySelector<HTMLElement>('[aria-expanded]')!.click();
    await vi.waitFor(() => expect(asked).not.toHaveLength(0), 30_000);
    return { model, root };
  };

  it('is read again after an undo, which adds no motion, and at most every 1.5 s', async () => {
    answers = { strokes: { strokes: [] } };
    const { model } = await open();
    vi.useFakeTimers();
    const change = async (removed_volume_mm3: number, afterMs: number): Promise<number> => {
      const plain = { motions: 7, state_hash: 'a', settled: true } as const;
      model.apply({ type: 'state', ...plain, removed_volume_mm3 });
      const before = asked.length;
      await vi.advanceTimersByTimeAsync(afterMs);
      return asked.length - before;
    };
    expect(await change(5, 100)).toBe(1);
    expect(await change(5, 10_000)).toBe(0);
    expect(await change(4, 0)).toBe(1);
    expect(await change(3, 1400)).toBe(0);
    expect(await change(3, 200)).toBe(1);
  });

  it('has the names of participants who left before the page came', async () => {
    const stroke = { id: 1, last: 9, participant: 3, tool: 1, begin_ms: 0, end_ms: 9, motions: 9 };
    answers = {
      strokes: { strokes: [{ ...stroke, undone: false }] },
      authors: { authors: [{ participant: 3, name: 'Lin', color: '#778899', kind: 'agent' }] },
    };
    const { root } = await open();
    await vi.waitFor(() => expect(root.querySelector('.strokes')?.textContent).toContain('Lin'));
  });
});
