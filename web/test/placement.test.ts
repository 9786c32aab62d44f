// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import { isRight, placedBox, placementJson, unplaced } from '../src/model/placement';
import { meshScene } from '../src/model/new_block';
import type { Box } from '../src/model/box';

const BOX: Box = { min: [0, 0, 0], max: [1, 2, 3] };

test('a scene states what of a placement is changed', () => {
  expect(placementJson(unplaced())).toBeNull();
  expect(meshScene('a.stl', true, unplaced())['stock']).toEqual({
    shape: 'mesh',
    file: 'a.stl',
    repair: true,
  });
  const placement = { ...unplaced(), unit: 'cm', scale: 2 };
  expect(placementJson(placement)).toEqual({ unit: 'cm', scale: [2, 2, 2] });
  placement.rotateDeg = [0, 90, 0];
  placement.translateMm = [0, 0, -1];
  expect(meshScene('a.stl', false, placement)['stock']).toEqual({
    shape: 'mesh',
    file: 'a.stl',
    placement: {
      unit: 'cm',
      scale: [2, 2, 2],
      rotate_deg: [0, 90, 0],
      translate_mm: [0, 0, -1],
    },
  });
});

test('a box is scaled, turned about X, Y and Z, then moved', () => {
  expect(placedBox(BOX, { ...unplaced(), unit: 'inch', scale: 10 })).toEqual({
    min: [0, 0, 0],
    max: [254, 508, 762],
  });
  const aboutX = { ...unplaced(), rotateDeg: [90, 0, 0] as Box['min'] };
  expect(placedBox(BOX, aboutX)).toEqual({ min: [0, -3, 0], max: [1, 0, 2] });
  const aboutY = { ...unplaced(), rotateDeg: [0, -270, 0] as Box['min'] };
  expect(placedBox(BOX, aboutY)).toEqual({ min: [0, 0, -1], max: [3, 2, 0] });
  const aboutXAndZ = {
    ...unplaced(),
    rotateDeg: [90, 0, 90] as Box['min'],
    translateMm: [5, 0, 0] as Box['min'],
  };
  expect(placedBox(BOX, aboutXAndZ)).toEqual({ min: [5, 0, 0], max: [8, 1, 2] });
});

test('other angles give the box around the turned box', () => {
  const placement = { ...unplaced(), rotateDeg: [0, 0, 45] as Box['min'] };
  expect(isRight(placement)).toBe(false);
  expect(isRight({ ...placement, rotateDeg: [0, 90, -180] })).toBe(true);
  const { min, max } = placedBox(BOX, placement);
  expect(min[0]).toBeCloseTo(-Math.SQRT2);
  expect(max[0]).toBeCloseTo(Math.SQRT1_2);
  expect(max[1]).toBeCloseTo(1.5 * Math.SQRT2);
});
