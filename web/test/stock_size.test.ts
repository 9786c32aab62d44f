// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { resized, sizesOf } from '../src/model/stock_size';

const BOARD = { shape: 'box', min_mm: [-60, -40, -20], max_mm: [60, 40, 0] };
const PLATE = { shape: 'box', min_mm: [0, 0, -25], max_mm: [120, 80, 0] };
const COLUMN = {
  ...{ shape: 'cylinder', center_mm: [0, 0] },
  ...{ radius_mm: 30, min_z_mm: -80, max_z_mm: 0 },
};
const MODEL = { shape: 'mesh', file: 'a.stl' };

describe('the sizes of a stock', () => {
  it('are the sides of a box, and diameter and height of a cylinder', () => {
    expect(sizesOf(BOARD)).toEqual([120, 80, 20]);
    expect(sizesOf(COLUMN)).toEqual([60, 80]);
    expect(sizesOf(MODEL)).toEqual([]);
    expect(sizesOf(undefined)).toEqual([]);
  });

  it('change from the origin', () => {
    const sizes = [200, 50, 30];
    expect(resized(BOARD, sizes)).toEqual({
      ...{ shape: 'box', min_mm: [-100, -25, -30], max_mm: [100, 25, 0] },
    });
    expect(resized(PLATE, sizes)).toEqual({
      ...{ shape: 'box', min_mm: [0, 0, -30], max_mm: [200, 50, 0] },
    });
    expect(resized(COLUMN, [20, 100])).toEqual({
      ...COLUMN,
      ...{ radius_mm: 10, min_z_mm: -100, max_z_mm: 0 },
    });
  });

  it('are kept by a value without one', () => {
    expect(resized(MODEL, [])).toEqual(MODEL);
    for (const stock of [BOARD, PLATE, COLUMN])
      expect(resized(stock, sizesOf(stock))).toEqual(stock);
  });
});
