// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h } from 'preact';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { SessionModel } from '../src/model/session';
import { Authors } from '../src/ui/authors';
import { OwnerTip, OwnerTipView } from '../src/ui/inspect/owner_tip';
import type { ParticipantInfo, Vec3 } from '../src/wire/types';
import { show } from './support/shown';
import { turn } from './support/turn';

const CUT = { record: 12, stroke: 9, participant: 2, tool: 1, begin_ms: 1e12, program: null };
const AUTHORS = { authors: [{ participant: 2, name: 'Ada', color: '#d9541e', kind: 'agent' }] };

describe('the tip that names who cut a point', () => {
  let root: HTMLElement;
  let tip: OwnerTip;
  let model: SessionModel;
  let asked: string[];
  let cut: unknown;
  let status: number;
  let isOverBlock: boolean;

  beforeEach(() => {
    asked = [];
    cut = CUT;
    status = 200;
    isOverBlock = true;
    vi.stubGlobal('fetch', (address: string) => {
      asked.push(address.replace('/v1/sessions/demo/', ''));
      const isProbe = address.includes('/probe');
      const answer = isProbe ? { surface: null, cut } : AUTHORS;
      const body = status === 200 ? answer : { error: { reason: 'the server is busy' } };
      return Promise.resolve({ ok: status === 200, status, json: () => Promise.resolve(body) });
    });
    model = new SessionModel();
    tip = new OwnerTip({
      model,
      session: 'demo',
      authors: new Authors(model, 'demo'),
      colorOf: (participant) => `#00000${participant}`,
      pick: (x, y) => {
        const [point, normal]: Vec3[] = [
          [x, y, 0],
          [0, 0, 1],
        ];
        return isOverBlock
          ? { snapped: { kind: 'face', point: point! }, point: point!, normal: normal! }
          : null;
      },
    });
    root = show(h(OwnerTipView, { tip }));
  });
  afterEach(() => vi.unstubAllGlobals());

  const shown = (): string => {
    const box = root.querySelector<HTMLElement>('.owner-tip')!;
    return box.hidden ? '' : box.textContent;
  };
  const color = (): HTMLElement => root.querySelector('.owner-color')!;
  async function rest(x: number, y: number, atMs = 0): Promise<void> {
    tip.move(x, y, atMs);
    tip.update('1', 'still', atMs + 200);
    await turn();
  }

  it('names person, tool, stroke and time, in the color of the legend', async () => {
    tip.update('1', 'still', 0);
    await rest(30, 40);
    expect(asked).toEqual(['probe?at_mm=30,40,0&normal=0,0,1', 'authors']);
    expect(shown()).toMatch(/^Adano tool · stroke · Sep \d, 2001, \d\d:46:40$/);
    expect(color().hidden).toBe(false);
    expect(color().style.background).toBe('#000002');
  });

  it('names the program and its line instead', async () => {
    cut = { ...CUT, program: { id: 1, name: 'first.ngc', line: 6 } };
    tip.update('1', 'still', 0);
    await rest(30, 40);
    expect(shown()).toContain('first.ngcno tool · line 6 · ');
  });

  it('names the stroke of a program whose line is not known', async () => {
    cut = { ...CUT, program: { id: 1, name: 'first.ngc', line: 0 } };
    tip.update('1', 'still', 0);
    await rest(30, 40);
    expect(shown()).toContain('first.ngcno tool · stroke · ');
  });

  it('asks for names once, and prefers those of present participants', async () => {
    tip.update('1', 'still', 0);
    await rest(30, 40);
    const info = { participant: 2, name: 'Ada L.', color: '#d9541e', tool: 1, kind: 'agent' };
    model.participants.setList([info] as ParticipantInfo[]);
    await rest(90, 40, 1000);
    expect(shown()).toContain('Ada L.');
    expect(asked.filter((what) => what === 'authors')).toHaveLength(1);
  });

  it('says that nobody has cut there, without a color', async () => {
    cut = null;
    tip.update('1', 'still', 0);
    await rest(30, 40);
    expect(shown()).toBe('Original stock surface, not cut yet.');
    expect(color().hidden).toBe(true);
  });

  it('asks nothing off the block, and continues after it', async () => {
    isOverBlock = false;
    tip.update('1', 'still', 0);
    await rest(30, 40);
    expect([asked, shown()]).toEqual([[], '']);
    isOverBlock = true;
    await rest(90, 40, 1000);
    expect(shown()).toContain('Ada');
  });

  it('says why the server tells nothing, and goes on', async () => {
    status = 503;
    tip.update('1', 'still', 0);
    await rest(30, 40);
    expect(shown()).toBe('The server is busy.');
    status = 200;
    await rest(90, 40, 1000);
    expect(shown()).toContain('Ada');
  });

  it('goes when the pointer goes on, the picture moves, or the answer comes too late', async () => {
    tip.update('1', 'still', 0);
    await rest(30, 40);
    tip.move(60, 40, 300);
    await turn();
    expect(shown()).toBe('');
    await rest(90, 40, 1000);
    expect(shown()).toContain('Ada');
    tip.update('1', 'turned', 1300);
    await turn();
    expect(shown()).toBe('');
    tip.update('1', 'turned', 1500); // at rest again
    await turn();
    expect(shown()).toContain('Ada');
    tip.move(10, 10, 2000);
    tip.update('1', 'turned', 2200);
    tip.leave();
    await turn();
    expect(shown()).toBe('');
  });

  it('says no error of a place that the pointer has left', async () => {
    status = 503;
    tip.update('1', 'still', 0);
    tip.move(30, 40, 0);
    tip.update('1', 'still', 200);
    tip.leave();
    await turn();
    expect(asked).toHaveLength(1);
    expect(shown()).toBe('');
  });

  it('goes where the block is cut away under the pointer', async () => {
    tip.update('1', 'still', 0);
    await rest(30, 40);
    isOverBlock = false;
    tip.update('2', 'still', 2000);
    await turn();
    expect(shown()).toBe('');
  });

  it('is that of a press at once', async () => {
    tip.update('1', 'still', 0);
    tip.press(30, 40);
    tip.update('1', 'still', 1);
    await turn();
    expect(shown()).toContain('Ada');
    tip.press(90, 40);
    await turn();
    expect(shown()).toBe('');
  });

  it('changes with the surface', async () => {
    tip.update('1', 'still', 0);
    await rest(30, 40);
    cut = { ...CUT, participant: 7 };
    tip.update('2', 'still', 2000);
    await turn();
    expect(shown()).toContain('Participant 7');
  });
});
