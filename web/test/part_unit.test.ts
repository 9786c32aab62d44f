// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h } from 'preact';
import { afterEach, describe, expect, it, vi } from 'vitest';
import { setTarget } from '../src/link/targets';
import type { SentPart, UnitAnswer } from '../src/link/targets';
import { PartUnit, PartUnitView } from '../src/ui/inspect/part_unit';
import { press, show } from './support/shown';
import { turn } from './support/turn';

const IN_METERS: SentPart = {
  name: 'part.stl',
  triangles: 12,
  min_mm: [-0.02, -0.01, 0],
  max_mm: [0.02, 0.01, 0.01],
  shift_mm: [0, 0, 0],
  questions: [
    {
      text: 'part.stl is 0.04 mm long',
      choices: [
        { unit: 'cm', size_mm: 0.4 },
        { unit: 'inch', size_mm: 1.016 },
        { unit: 'm', size_mm: 40 },
      ],
    },
  ],
};
const HUGE: SentPart = {
  ...IN_METERS,
  max_mm: [40_000, 10, 10],
  min_mm: [0, 0, 0],
  questions: [{ text: '', choices: [{ scale: 0.001, size_mm: 40 }] }],
};

describe('the unit of a part', () => {
  afterEach(() => vi.unstubAllGlobals());

  function ask(part: SentPart | null) {
    const answers: UnitAnswer[] = [];
    const unit = new PartUnit((answer) => answers.push(answer));
    unit.ask(part);
    const root = show(h(PartUnitView, { unit }));
    const buttons = [...root.querySelectorAll('button')];
    return { unit, answers, root, buttons, texts: buttons.map(({ textContent }) => textContent) };
  }

  it('is asked for with the size that each unit makes', async () => {
    const { answers, root, buttons, texts } = ask(IN_METERS);
    expect(root.querySelector('[role=alert]')!.textContent).toContain('right size?');
    expect(texts).toEqual(['mm: 0.040 mm', 'cm: 0.400 mm', 'inch: 1.016 mm', 'm: 40.000 mm']);
    await press(buttons[3]!);
    expect(answers).toEqual([{ unit: 'm', size_mm: 40 }]);
    expect(root.childElementCount).toBe(0);
  });

  it('may be a factor for a part of a thousand times the size', () => {
    expect(ask(HUGE).texts).toEqual(['mm: 40,000.000 mm', '× 0.001: 40.000 mm']);
  });

  it('is not asked for where the size is likely, or without a part', async () => {
    expect(ask({ ...IN_METERS, questions: [] }).root.childElementCount).toBe(0);
    const { unit, root } = ask(IN_METERS);
    expect(root.childElementCount).toBe(1);
    unit.ask(null);
    await turn();
    expect(root.childElementCount).toBe(0);
  });

  it('is sent with the file', async () => {
    const asked: string[] = [];
    vi.stubGlobal('fetch', (address: string) => {
      asked.push(address);
      return Promise.resolve({ ok: true, json: () => Promise.resolve(IN_METERS) });
    });
    const file = new File(['solid'], 'part.stl');
    for (const as of [undefined, { unit: 'm', size_mm: 40 }, { scale: 0.001, size_mm: 40 }])
      await setTarget('demo', file, [1, 2, 3], as);
    const path = '/v1/sessions/demo/targets?name=part.stl&shift_mm=1,2,3';
    expect(asked).toEqual([path, `${path}&unit=m`, `${path}&scale=0.001`]);
  });
});
