// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import {
  adapted,
  ageText,
  bytesText,
  freeId,
  motionPriceText,
  priceText,
  stockBox,
  stockText,
  targetOf,
  timeText,
  withStock,
} from '../src/model/new_block';
import { originText } from '../src/ui/lobby/tool_table';

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

test('the stock of a program can be changed, and the rest of its scene stays', () => {
  const scene = {
    stock: { shape: 'box', min_mm: [0, 0, -5], max_mm: [9, 9, 0] },
    tools: [{ id: 3 }],
    machine: { kinematics: 'xyzac-trt' },
  };
  const box = stockBox(scene)!;
  box.min[2] = -7;
  expect(withStock(scene, box)).toEqual({
    ...scene,
    stock: { shape: 'box', min_mm: [0, 0, -7], max_mm: [9, 9, 0] },
  });
  expect(scene.stock.min_mm[2]).toBe(-5);
  expect(stockBox({ stock: { shape: 'mesh', file: 'a.stl' } })).toBeNull();
});

test('a derived scene says where its fields come from', () => {
  expect(
    originText([
      { tool: 1, field: 'shape', origin: 'assumed', source: '' },
      { tool: 1, field: 'diameter_mm', origin: 'stated', source: 'comment in line 3' },
      { tool: 1, field: 'corner_radius_mm', origin: 'stated', source: 'comment in line 3' },
    ]),
  ).toBe('shape assumed; diameter, corner radius given (comment, line 3)');
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
    '0.2\u00a0mm: up to 2\u00a0MB of memory, 410\u00a0ms to join',
  );
  expect(priceText({ bytes: 2e6, usPerMotion: 50, motions: 46_000, joinS: 0.41 }, 0.2)).toBe(
    '0.2\u00a0mm: up to 2\u00a0MB of memory, 2.3\u00a0s to carve, 410\u00a0ms to join',
  );
  expect(motionPriceText({ bytes: 2e6, usPerMotion: 50, joinS: 0.41 })).toBe(
    '50\u00a0µs per motion',
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
