// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Stroke } from '../src/model/stroke';
import type { StateMessage } from '../src/wire/types';
import {
  barsOf,
  joined,
  mayHaveUndone,
  openSince,
  recordAt,
  rowsOf,
  strokeAt,
  xOf,
  zoomed,
} from '../src/model/timeline';

function stroke(id: number, last: number, participant = 1, undone = false): Stroke {
  return { id, last, participant, tool: 1, motions: 1, begin_ms: 1, end_ms: 2, undone };
}

/** A repeatable number from 0 to 1. */
function random(seed: number): number {
  const x = Math.sin(seed * 12.9898) * 43758.5453;
  return x - Math.floor(x);
}

/** Strokes of random lengths and gaps, of which a part is undone. */
function manyStrokes(count: number): Stroke[] {
  const strokes: Stroke[] = [];
  let at = 1;
  for (let n = 0; n < count; n += 1) {
    const length = Math.ceil(random(n) ** 8 * 4000);
    strokes.push(stroke(at, at + length, 1, random(n + 0.5) < 0.3));
    at += length + 1 + Math.floor(random(n + 0.25) ** 12 * 3000);
  }
  return strokes;
}

describe('bars of strokes', () => {
  it('are where the strokes are', () => {
    const strokes = [stroke(1, 100), stroke(201, 300, 1, true), stroke(301, 400)];
    expect(barsOf(strokes, { from: 0, to: 1000 }, 500)).toEqual([
      { left: 0, right: 50, undone: false },
      { left: 100, right: 150, undone: true },
      { left: 150, right: 200, undone: false },
    ]);
    expect(barsOf(strokes, { from: 250, to: 350 }, 100)).toEqual([
      { left: 0, right: 50, undone: true },
      { left: 50, right: 100, undone: false },
    ]);
  });

  it.each([100, 1000, 100_000])('are few for %i strokes, and hide none', (count) => {
    const strokes = manyStrokes(count);
    const span = { from: 0, to: strokes.at(-1)!.last };
    const width = 700;
    const bars = barsOf(strokes, span, width);
    expect(bars.length).toBeLessThanOrEqual(2 * width);
    bars.forEach((bar, n) => {
      if (n > 0) expect(bar.left).toBeGreaterThanOrEqual(bars[n - 1]!.right - 1);
    });
    // Each stroke is in a bar, and wide ones in one that says whether they are undone.
    for (const { id, last, undone } of strokes) {
      const left = xOf(id - 1, span, width);
      const right = xOf(last, span, width);
      const over = bars.filter((bar) => bar.left <= left + 1e-9 && bar.right >= right - 1e-9);
      if (over.length === 0) throw new Error(`stroke ${id} is in no bar`);
      if (right - left >= 1 && !over.some((bar) => bar.undone === undone))
        throw new Error(`stroke ${id} looks ${undone ? 'standing' : 'undone'}`);
    }
  });

  it('of thin strokes are apart where there is a pixel between them', () => {
    const strokes = [stroke(1, 2), stroke(301, 302), stroke(401, 402)];
    const bars = barsOf(strokes, { from: 0, to: 10_000 }, 50);
    expect(bars.map(({ left, right }) => [left, right])).toEqual([
      [0, 0.01],
      [1.5, 2.01],
    ]);
  });

  it('are not undone if a stroke in a thin one stands', () => {
    const strokes = [stroke(1, 2, 1, true), stroke(3, 4), stroke(5, 6, 1, true)];
    const bars = barsOf(strokes, { from: 0, to: 60_000 }, 100);
    expect(bars).toHaveLength(1);
    expect(bars[0]?.undone).toBe(false);
  });
});

describe('the timeline', () => {
  it('has a row for each participant, in the order of their first strokes', () => {
    const rows = rowsOf([stroke(1, 2, 7), stroke(3, 4, 2), stroke(5, 6, 7)]);
    expect(rows.map(({ participant }) => participant)).toEqual([7, 2]);
    expect(rows[0]?.strokes.map(({ id }) => id)).toEqual([1, 5]);
  });

  it('finds every record under the place where it draws it', () => {
    const span = { from: 100, to: 900 };
    for (const record of [100, 101, 500, 899, 900])
      expect(recordAt(xOf(record, span, 8000), span, 8000)).toBe(record);
    expect(recordAt(-5, span, 800)).toBe(100);
    expect(recordAt(5000, span, 800)).toBe(900);
    expect(recordAt(5, { from: 0, to: 0 }, 0)).toBe(0);
  });

  it('finds the stroke at a record, or the nearest one that is near enough', () => {
    const strokes = [stroke(10, 20), stroke(30, 40), stroke(41, 50)];
    const found = (record: number, slack = 0) => strokeAt(strokes, record, slack)?.id;
    expect([9, 10, 20, 21, 40, 41, 51].map((record) => found(record))).toEqual([
      undefined,
      10,
      10,
      undefined,
      30,
      41,
      undefined,
    ]);
    expect([9, 23, 27, 53].map((record) => found(record, 3))).toEqual([10, 10, 30, 41]);
    expect(strokeAt([], 5, 100)).toBeUndefined();
  });

  it('keeps the record under the pointer in place when it is zoomed, within the journal', () => {
    const all = { from: 0, to: 1000 };
    const near = zoomed(all, 300, 0.5, 1000);
    expect(near).toEqual({ from: 150, to: 650 });
    expect(xOf(300, near, 100)).toBeCloseTo(xOf(300, all, 100));
    expect(zoomed(near, 300, 10, 1000)).toEqual(all);
    expect(zoomed(all, 1000, 0.1, 1000)).toEqual({ from: 900, to: 1000 });
  });

  it('asks again for strokes that may still grow, and puts them in place of the old ones', () => {
    const old = [stroke(1, 5, 1), stroke(2, 9, 2), stroke(6, 8, 1)];
    const since = openSince(rowsOf(old));
    expect(since).toBe(2); // the last one of participant 2
    const newer = [stroke(2, 19, 2), stroke(6, 8, 1), stroke(12, 18, 1)];
    expect(joined(old, since, newer).map(({ id, last }) => [id, last])).toEqual([
      [1, 5],
      [2, 19],
      [6, 8],
      [12, 18],
    ]);
    expect(openSince([])).toBe(0);
    expect(joined(old, 0, newer)).toEqual(newer);
  });
});

describe('an undo', () => {
  const state = (motions: number, removed: number, hash: string): StateMessage => ({
    ...{ type: 'state', motions, removed_volume_mm3: removed, state_hash: hash, settled: true },
  });
  const before = state(100, 50, 'a');

  it('is seen by more of the block, or by a change without a motion', () => {
    expect(mayHaveUndone(before, state(100, 50, 'a'))).toBe(false);
    expect(mayHaveUndone(before, state(120, 60, 'b'))).toBe(false);
    expect(mayHaveUndone(before, state(120, 50, 'b'))).toBe(false); // through the air
    expect(mayHaveUndone(before, state(120, 40, 'b'))).toBe(true);
    expect(mayHaveUndone(before, state(100, 60, 'b'))).toBe(true); // a redo
  });
});
