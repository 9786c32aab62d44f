// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import {
  angleOf,
  areaText,
  circleThrough,
  depthOf,
  distanceOf,
  faceAngle,
  fromUnit,
  inUnit,
  lengthText,
  partsText,
  radiusOf,
  valueText,
} from '../src/model/measure';
import type { Vec3 } from '../src/wire/types';

const SQRT = Math.SQRT1_2;

describe('circleThrough', () => {
  it('finds circles of any attitude', () => {
    const [u, v]: [Vec3, Vec3] = [
      [SQRT, 0, SQRT],
      [0, 1, 0],
    ];
    const on = (angle: number): Vec3 =>
      [3, -4, 5].map((c, n) => c + 7 * (Math.cos(angle) * u[n]! + Math.sin(angle) * v[n]!)) as Vec3;
    const circle = circleThrough(on(0.1), on(1.3), on(4))!;
    expect(circle.radius).toBeCloseTo(7, 9);
    circle.center.forEach((value, n) => expect(value).toBeCloseTo([3, -4, 5][n]!, 9));
    expect(Math.abs(circle.normal[0])).toBeCloseTo(SQRT, 9);
  });

  it('finds none through points on a line, or twice the same', () => {
    expect(circleThrough([0, 0, 0], [1, 2, 3], [2, 4, 6])).toBeNull();
    expect(circleThrough([0, 0, 0], [1, 2, 3], [1, 2, 3])).toBeNull();
  });
});

describe('measures', () => {
  it('knows the angle of the material between faces', () => {
    expect(faceAngle([0, 0, 1], [1, 0, 0])).toBeCloseTo(90, 9);
    expect(faceAngle([0, 0, 1], [0, 0, 1])).toBeCloseTo(180, 9);
    expect(faceAngle([0, 0, 1], [SQRT, 0, SQRT])).toBeCloseTo(135, 9);
  });

  it('draws the measured lines', () => {
    const far = distanceOf([1, 2, 3], [4, -2, 3]);
    expect(far).toMatchObject({ value: 5, place: [2.5, 0, 3], parts: [3, 4, 0] });
    expect(depthOf([1, 2, -7.5], 0)).toMatchObject({ value: 7.5, place: [1, 2, -3.75] });
    const round = radiusOf([5, 0, 0], [0, 5, 0], [-5, 0, 0])!;
    expect(round.value).toBeCloseTo(5, 9);
    for (const point of round.line) expect(Math.hypot(...point)).toBeCloseTo(5, 9);
    const corner = angleOf(
      { point: [0, 0, 0], normal: [0, 0, 1] },
      { point: [2, 0, -1], normal: [1, 0, 0] },
      3,
    );
    expect(corner.line).toEqual([
      [0, 0, 3],
      [0, 0, 0],
      [2, 0, -1],
      [5, 0, -1],
    ]);
  });
});

describe('texts', () => {
  it('writes millimeters and inches', () => {
    expect(lengthText(1234.5678, 'mm')).toBe('1,234.568 mm');
    expect(lengthText(25.4, 'in')).toBe('1.0000 in');
    expect(lengthText(-0.0001, 'mm')).toBe('0.000 mm');
    expect(areaText(645.16, 'in')).toBe('1.0000 in²');
    expect(fromUnit(inUnit(7, 'in'), 'in')).toBeCloseTo(7, 9);
    const far = distanceOf([0, 0, 0], [3, 4, 0]);
    expect(valueText(far, 'mm')).toBe('5.000 mm');
    expect(partsText(far, 'mm')).toBe('Δx 3.000 · Δy 4.000 · Δz 0.000');
    const round = radiusOf([5, 0, 0], [0, 5, 0], [-5, 0, 0])!;
    expect(valueText(round, 'mm')).toBe('R 5.000 mm · ⌀ 10.000 mm');
    expect(partsText(round, 'mm')).toBe('');
  });
});
