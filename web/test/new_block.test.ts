// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import {
  adapted,
  ageText,
  bytesText,
  freeId,
  priceText,
  programScene,
  stockFor,
  stockText,
  targetOf,
  timeText,
  toolsInComments,
  toolsOf,
} from '../src/model/new_block';
import type { ToolChoice } from '../src/model/new_block';

const tool = (diameterMm: number): ToolChoice => ({
  id: 1,
  shape: 'flat',
  diameterMm,
  cornerMm: 0,
});

test('a template keeps everything but its name and accuracy', () => {
  const scene = { name: 'Relief', stock: 1, accuracy: { pitch_mm: 0.4, rays: 'dexel' } };
  expect(adapted(scene, 'Mine', 0.05)).toEqual({
    name: 'Mine',
    stock: 1,
    accuracy: { target_mm: 0.05 },
  });
  const three = { accuracy: { target_mm: 1, rays: 'tri-dexel' } };
  expect(adapted(three, 'A', 0.2)['accuracy']).toEqual({ target_mm: 0.2, rays: 'tri-dexel' });
});

test('the slider begins at the accuracy of the template, or the next finer one', () => {
  expect(targetOf({ accuracy: { target_mm: 0.2 } })).toBe(0.2);
  expect(targetOf({ accuracy: { target_mm: 0.3 } })).toBe(0.2);
  expect(targetOf({ accuracy: { pitch_mm: 0.4 } })).toBe(0.2);
  expect(targetOf({ accuracy: { target_mm: 0.001 } })).toBe(0.01);
  expect(targetOf({})).toBe(0.1);
});

test('a stock holds all feeds and the tool beside them', () => {
  const feed = { min: [1.2, 0, -3.5], max: [40, 19.9, -1] } as const;
  expect(stockFor({ min: [...feed.min], max: [...feed.max] }, [tool(6), tool(3)])).toEqual({
    min: [-2, -3, -6],
    max: [43, 23, 0],
  });
  // A zero below the part.
  expect(stockFor({ min: [0, 0, 2], max: [10, 10, 12.5] }, [tool(2)])).toEqual({
    min: [-1, -1, 0],
    max: [11, 11, 13],
  });
  const none = stockFor(null, []);
  expect(none.max[2]).toBeGreaterThan(none.min[2]);
});

test.each([
  ['(T1 D=6. CR=0. - ZMIN=-5. - flat end mill)', [1, 'flat', 6, 0]],
  ['(T2 D=6. CR=3. - ball end mill)', [2, 'ball', 6, 3]],
  ['(T12 D=10 CR=1.5 - bullnose)', [12, 'bull_nose', 10, 1.5]],
  ['(T3 3.5MM BALL NOSE)', [3, 'ball', 3.5, 0]],
  ['; TOOL #4: DIA .5 ENDMILL', [4, 'flat', 0.5, 0]],
  ['(Tool 5 | Diameter: 8.0 mm)', [5, 'flat', 8, 0]],
])('the comment %s describes a tool', (text, [id, shape, diameterMm, cornerMm]) => {
  expect(toolsInComments(`G21\n${text}\nT1 M6\n`)).toEqual(
    new Map([[id, { shape, diameterMm, cornerMm }]]),
  );
});

test.each([
  ['G20\n(T1 D=0.25 CR=0. - FLAT END MILL)', 'flat', 6.35, 0],
  ['N10G90G20(T1 D=.5 CR=.0625)', 'bull_nose', 12.7, 1.5875],
  ['G20\n(T1 D=6MM CR=.0625 IN)', 'bull_nose', 6, 1.5875],
  ['G20\n(T1 6MM BALL)', 'ball', 6, 0],
  ['G21\n(T1 0.25 IN END MILL)', 'flat', 6.35, 0],
  ['G21\n(T1 0.25" BALL)', 'ball', 6.35, 0],
  ['(G20 IS NOT USED)\nG21\n(T1 D=6)', 'flat', 6, 0],
  ['G200\n(T1 D=6)', 'flat', 6, 0],
  ['(T1 D=6)\nG21\nG20', 'flat', 6, 0],
  ['G20\n(T1 1/2 IN BALL)', 'ball', 12.7, 0],
  ['G20\n(T1 D=1-1/4 FLAT)', 'flat', 31.75, 0],
  ['G21\n(T1 1 1/2" FLAT)', 'flat', 38.1, 0],
  ['UNITS/INCHES\n(T1 D=1)', 'flat', 25.4, 0],
])('%s: sizes without a unit are in that of the program', (text, shape, diameterMm, cornerMm) => {
  expect(toolsInComments(text).get(1)).toEqual({ shape, diameterMm, cornerMm });
});

test.each([
  '(T1)',
  'T1 D6',
  '(T1 D=0)',
  '(T1 1/0 IN)',
  '(5 AXIS, TOOLS 1 AND 2)',
  '(TOP OF PART D=5)',
])('the line %s describes none', (text) => {
  expect(toolsInComments(text).size).toBe(0);
});

test('tools without a description can be edited, and programs without tools have one', () => {
  const facts = {
    kinematics: 'xyz',
    tools: [2, 7],
    feedMm: null,
    motions: 1,
    programmedS: 1,
    machineS: 2,
  };
  expect(toolsOf(facts, '(T7 D=3. CR=1.5)')).toEqual([
    { id: 2, shape: 'flat', diameterMm: 6, cornerMm: 0 },
    { id: 7, shape: 'ball', diameterMm: 3, cornerMm: 1.5 },
  ]);
  expect(toolsOf({ ...facts, tools: [] }, '').map(({ id }) => id)).toEqual([1]);
});

test('a scene for a program has its tools, stock and machine', () => {
  const box = { min: [0, 0, -5], max: [9, 9, 0] } as const;
  const bull: ToolChoice = { id: 3, shape: 'bull_nose', diameterMm: 10, cornerMm: 1 };
  const scene = programScene(
    { min: [...box.min], max: [...box.max] },
    [bull, tool(6)],
    'xyzac-trt',
  );
  expect(scene['stock']).toEqual({ shape: 'box', min_mm: [0, 0, -5], max_mm: [9, 9, 0] });
  expect(scene['machine']).toEqual({ kinematics: 'xyzac-trt' });
  expect(scene['tools']).toEqual([
    { id: 3, shape: 'bull_nose', diameter_mm: 10, corner_radius_mm: 1, length_mm: 50 },
    { id: 1, shape: 'flat', diameter_mm: 6, length_mm: 30 },
  ]);
});

test('prices are short sentences', () => {
  expect(timeText(38.4)).toBe('38\u00a0µs');
  expect(timeText(3007)).toBe('3\u00a0ms');
  expect(timeText(2.34e6)).toBe('2.3\u00a0s');
  expect(bytesText(1.2e8)).toBe('120\u00a0MB');
  expect(bytesText(0)).toBe('0\u00a0B');
  expect(bytesText(999_600)).toBe('1\u00a0MB');
  expect(timeText(999.6)).toBe('1\u00a0ms');
  expect(priceText({ bytes: 2e6, usPerMotion: 50, joinS: 0.41 }, 0.2)).toBe(
    '0.2\u00a0mm: 50\u00a0µs a motion; carved all over 2\u00a0MB, joins in 410\u00a0ms',
  );
});

test('stocks, ages and ids are put in a few words', () => {
  expect(stockText({ shape: 'box', min_mm: [-60, 0, -20.25], max_mm: [60, 80, 0] })).toBe(
    '120 × 80 × 20.3 mm',
  );
  expect(stockText({ shape: 'cylinder', radius_mm: 30, min_z_mm: -80, max_z_mm: 0 })).toBe(
    '⌀ 60 × 80 mm',
  );
  expect(stockText(undefined)).toBe('');
  expect(['just now', '1 min ago', '59 min ago', '1 h ago', 'a day ago', '3 days ago']).toEqual(
    [59e3, 60e3, 3599e3, 3600e3, 86400e3, 3 * 86400e3].map((ago) => ageText(1e12 - ago, 1e12)),
  );
  expect(freeId('Bracket, op 1', [])).toBe('bracket-op-1');
  expect(freeId('Bracket, op 1', ['bracket-op-1', 'bracket-op-1-2'])).toBe('bracket-op-1-3');
  expect(freeId('Ärmel', [])).toBe('armel');
  expect(freeId('日本', [])).toBe('block');
  expect(freeId('x'.repeat(80), []).length).toBeLessThanOrEqual(60);
});
