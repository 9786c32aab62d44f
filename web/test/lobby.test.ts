// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { SessionSummary } from '../src/link/api';
import { SessionModel } from '../src/model/session';
import { History } from '../src/ui/history';
import { Cards } from '../src/ui/lobby/cards';
import { fromFile } from '../src/ui/lobby/drafts';
import { Lobby } from '../src/ui/lobby/lobby';
import { FakeElement, stubPage } from './support/fake_dom';
import { turn } from './support/turn';

function session(id: string, activeMs: number, motions = 1, removedVolumeMm3 = 5): SessionSummary {
  return { id, name: id, motions, removedVolumeMm3, participants: 0, activeMs };
}

/** The server's answers by the end of a path; any other request fails with a reason. */
let answers: Record<string, unknown>;
let asked: string[];

beforeEach(() => {
  stubPage();
  vi.stubGlobal('HTMLElement', FakeElement);
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
afterEach(() => vi.unstubAllGlobals());

describe('the cards of the lobby', () => {
  const names = (cards: Cards): string[] =>
    (cards.element as unknown as FakeElement).children.map(
      (card) => /a|b|c/.exec(card.all('card-text')[0]!.children[0]!.textContent)![0],
    );

  it('have the one that changed last first', () => {
    const cards = new Cards();
    cards.update([session('a', 1), session('b', 3), session('c', 2)], { close: null });
    expect(names(cards)).toEqual(['b', 'c', 'a']);
    cards.update([session('a', 9), session('b', 3), session('c', 2)], { close: null });
    expect(names(cards)).toEqual(['a', 'b', 'c']);
    const { changes } = cards.element as unknown as FakeElement;
    cards.update([session('a', 9), session('b', 3), session('c', 2)], { close: null });
    expect((cards.element as unknown as FakeElement).changes).toBe(changes);
  });

  it('show a new picture after an undo, which adds no motion', () => {
    const cards = new Cards();
    const shown = (): string => {
      const place = (cards.element as unknown as FakeElement).children[0]!;
      return (place.all('card-picture')[0] as unknown as { src: string }).src;
    };
    cards.update([session('a', 1)], { close: null });
    cards.update([session('a', 1)], { close: null });
    const before = shown();
    cards.update([session('a', 2, 1, 4)], { close: null });
    expect(shown()).not.toBe(before);
  });
});

describe('the alert of the lobby', () => {
  it('stays when the list comes, unless it is of the list', async () => {
    let poll = (): void => undefined;
    vi.stubGlobal('setInterval', (action: () => void) => {
      poll = action;
      return 0;
    });
    Object.assign(document, { hidden: false, addEventListener: () => undefined });
    vi.stubGlobal('localStorage', { getItem: () => null });
    const app = new FakeElement();
    new Lobby(app as unknown as HTMLElement, []);
    await turn();
    const fault = app.all('fault')[0]!;
    expect(fault.textContent).toBe('The server is busy.'); // of the templates
    answers = { '/v1/sessions': { sessions: [] } };
    poll();
    await turn();
    expect(fault.textContent).toBe('The server is busy.');
    expect(fault.hidden).toBe(false);
    answers = {};
    poll();
    await turn();
    expect(fault.textContent).toContain('503');
    answers = { '/v1/sessions': { sessions: [] } };
    poll();
    await turn();
    expect(fault.textContent).toBe('');
    expect(fault.hidden).toBe(true);
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
  const draftOf = (name: string) => fromFile(new File(['M30\n'], name), () => undefined, false);

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
  it('is read again after an undo, which adds no motion', async () => {
    answers = { strokes: { strokes: [] } };
    const model = new SessionModel();
    const history = new History(model, 'demo');
    const show = (history.element as unknown as FakeElement).all('quiet-action')[0]!;
    show.click();
    await vi.waitFor(() => expect(asked).toHaveLength(1));
    const tick = async (nowMs: number, removed_volume_mm3: number): Promise<void> => {
      const plain = { motions: 7, state_hash: 'a', settled: true } as const;
      model.apply({ type: 'state', ...plain, removed_volume_mm3 });
      history.update(null, nowMs);
      await turn();
    };
    await tick(10_000, 5);
    await tick(20_000, 5);
    const before = asked.length;
    await tick(30_000, 4);
    expect(asked).toHaveLength(before + 1);
  });

  it('has the names of participants who left before the page came', async () => {
    const stroke = { id: 1, last: 9, participant: 3, tool: 1, begin_ms: 0, end_ms: 9, motions: 9 };
    answers = {
      strokes: { strokes: [{ ...stroke, undone: false }] },
      authors: { authors: [{ participant: 3, name: 'Lin', color: '#778899', kind: 'agent' }] },
    };
    const history = new History(new SessionModel(), 'demo');
    const element = history.element as unknown as FakeElement;
    element.all('quiet-action')[0]!.click();
    await vi.waitFor(() => expect(element.all('strokes')[0]?.textContent).toContain('Lin'));
  });
});
