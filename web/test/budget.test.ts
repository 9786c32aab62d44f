// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { viewBudget } from '../src/link/budget';
import { helloText } from '../src/link/hello';
import { SessionModel } from '../src/model/session';
import { connectionText } from '../src/ui/badge';
import { parseControl } from '../src/wire/control';

const budget = (query: string, line: unknown = {}): number =>
  viewBudget(new URLSearchParams(query), line);

describe('the budget of a page', () => {
  it("is stated in its address, in kB/s, within the server's bounds", () => {
    expect(budget('?session=a&budget=200')).toBe(200_000);
    expect(budget('?budget=62.5')).toBe(62_500);
    expect(budget('?budget=1')).toBe(25_000);
    expect(budget('?budget=1e9')).toBe(1_000_000_000);
  });

  it('is any where nothing or nonsense is stated', () => {
    for (const query of ['', '?budget=', '?budget=fast', '?budget=-5', '?budget=0', '?budget=NaN'])
      expect(budget(query)).toBe(0);
  });

  it('is 200 kB/s where the browser saves data, unless the address states another one', () => {
    expect(budget('', { saveData: true })).toBe(200_000);
    expect(budget('', { saveData: false })).toBe(0);
    expect(budget('?budget=400', { saveData: true })).toBe(400_000);
    expect(budget('?budget=0', { saveData: true })).toBe(0);
  });

  it('stands in the hello, unless it is any', () => {
    expect(JSON.parse(helloText('Eve', null, 200_000))).toMatchObject({ budget: 200_000 });
    expect(JSON.parse(helloText('Eve', null, 0))).not.toHaveProperty('budget');
  });

  it('is shown as the server states it', () => {
    const model = new SessionModel();
    model.setStatus('connected', '');
    const welcome = {
      type: 'welcome',
      session: 'demo',
      participant: 9,
      epoch: 1,
      color: '#888888',
      pitch_mm: 0.5,
      pivot_mm: 60,
      stock: { shape: 'box', min_mm: [0, 0, 0], max_mm: [1, 1, 1] },
      tools: [],
      participants: [],
      grid: { origin_mm: [0, 0, 0], columns: [2, 2], tile: 32 },
    };
    for (const [fields, shown] of [
      [{ budget: 100_000 }, ' · up to 100 kB/s'],
      [{}, ''],
    ] as const) {
      const parsed = parseControl(JSON.stringify({ ...welcome, ...fields }));
      if (!parsed.ok || parsed.value === null) throw new Error('the welcome was refused');
      model.apply(parsed.value);
      expect(connectionText(model, 1000)).toMatch(
        new RegExp(`^Round trip .* · 0 frames/s · up to date${shown}$`),
      );
    }
  });
});
