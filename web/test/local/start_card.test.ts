// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h } from 'preact';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { forgetStrokes, keptStrokes } from '../../src/local/autosave';
import { StartCard } from '../../src/local/start_card';
import { show } from '../support/shown';
import { turn } from '../support/turn';

vi.mock('../../src/local/autosave', () => ({ keptStrokes: vi.fn(), forgetStrokes: vi.fn() }));

const KEPT = { name: 'wave.kerf', bytes: new Uint8Array([1, 2, 3]), atMs: 0 };

describe('the empty page without a server', () => {
  const actions = { choose: vi.fn(), example: vi.fn(), carve: vi.fn(), goOn: vi.fn() };

  beforeEach(() => {
    vi.clearAllMocks();
    vi.mocked(forgetStrokes).mockResolvedValue();
  });
  afterEach(() => {
    vi.restoreAllMocks();
  });

  const make = (): HTMLElement => show(h(StartCard, { ...actions, hidden: false }));
  const button = (card: HTMLElement, text: string): HTMLElement | undefined =>
    [...card.querySelectorAll('button')].find((one) => one.textContent === text);
  const kept = (card: HTMLElement): Element => card.querySelector('.kept-strokes')!;

  it('offers the strokes that the browser has kept, to go on with', async () => {
    vi.mocked(keptStrokes).mockResolvedValue(KEPT);
    const card = make();
    await vi.waitFor(() => expect(button(card, 'Restore')).toBeDefined());
    expect(kept(card).textContent).toMatch(/^You have unsaved strokes from /);
    button(card, 'Restore')!.click();
    await turn();
    expect(actions.goOn).toHaveBeenCalledWith(KEPT);
    expect(forgetStrokes).not.toHaveBeenCalled();
    expect(button(card, 'Restore')).toBeUndefined();
  });

  it('forgets them if they are discarded', async () => {
    vi.mocked(keptStrokes).mockResolvedValue(KEPT);
    const card = make();
    await vi.waitFor(() => expect(button(card, 'Discard')).toBeDefined());
    button(card, 'Discard')!.click();
    await turn();
    expect(forgetStrokes).toHaveBeenCalledOnce();
    expect(actions.goOn).not.toHaveBeenCalled();
    expect(kept(card).children).toHaveLength(0);
  });

  it.each([
    ['has kept none', () => Promise.resolve(null)],
    ['stores nothing', () => Promise.reject(new Error('private'))],
  ])('offers none where the browser %s', async (_case, answer) => {
    vi.spyOn(console, 'warn').mockImplementation(() => undefined);
    vi.mocked(keptStrokes).mockImplementation(answer);
    const card = make();
    await vi.waitFor(() => expect(keptStrokes).toHaveBeenCalledOnce());
    await turn();
    expect(kept(card).children).toHaveLength(0);
    button(card, 'Carve a block by hand')!.click();
    expect(actions.carve.mock.calls[0]![0]).not.toHaveLength(0);
  });
});
