// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { forgetStrokes, keptStrokes } from '../../src/local/autosave';
import { startCard } from '../../src/local/start_card';
import type { FakeElement } from '../support/fake_dom';
import { stubPage } from '../support/fake_dom';

vi.mock('../../src/local/autosave', () => ({ keptStrokes: vi.fn(), forgetStrokes: vi.fn() }));

const KEPT = { name: 'wave.kerf', bytes: new Uint8Array([1, 2, 3]), atMs: 0 };

describe('the empty page without a server', () => {
  const actions = { choose: vi.fn(), example: vi.fn(), carve: vi.fn(), goOn: vi.fn() };

  beforeEach(() => {
    stubPage();
    vi.clearAllMocks();
    vi.mocked(forgetStrokes).mockResolvedValue();
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.restoreAllMocks();
  });

  const make = (): FakeElement => startCard(actions) as unknown as FakeElement;
  const button = (card: FakeElement, text: string): FakeElement | undefined =>
    card.all('button').find((one) => one.textContent === text);

  it('offers the strokes that the browser has kept, to go on with', async () => {
    vi.mocked(keptStrokes).mockResolvedValue(KEPT);
    const card = make();
    await vi.waitFor(() => expect(button(card, 'Restore')).toBeDefined());
    expect(card.all('kept-strokes')[0]!.textContent).toMatch(/^You have unsaved strokes from /);
    button(card, 'Restore')!.click();
    expect(actions.goOn).toHaveBeenCalledWith(KEPT);
    expect(forgetStrokes).not.toHaveBeenCalled();
    expect(button(card, 'Restore')).toBeUndefined();
  });

  it('forgets them if they are discarded', async () => {
    vi.mocked(keptStrokes).mockResolvedValue(KEPT);
    const card = make();
    await vi.waitFor(() => expect(button(card, 'Discard')).toBeDefined());
    button(card, 'Discard')!.click();
    expect(forgetStrokes).toHaveBeenCalledOnce();
    expect(actions.goOn).not.toHaveBeenCalled();
    expect(card.all('kept-strokes')[0]!.children).toEqual([]);
  });

  it.each([
    ['has kept none', () => Promise.resolve(null)],
    ['stores nothing', () => Promise.reject(new Error('private'))],
  ])('offers none where the browser %s', async (_case, answer) => {
    vi.spyOn(console, 'warn').mockImplementation(() => undefined);
    vi.mocked(keptStrokes).mockImplementation(answer);
    const card = make();
    await Promise.resolve();
    expect(card.all('kept-strokes')[0]!.children).toEqual([]);
    button(card, 'Carve a block by hand')!.click();
    expect(actions.carve.mock.calls[0]![0]).not.toHaveLength(0);
  });
});
