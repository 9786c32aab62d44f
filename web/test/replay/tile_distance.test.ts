// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { isSameSurface, squareToTriangle } from '../../src/replay/tile_distance';
import type { Vec3 } from '../../src/wire/types';

const TRIANGLE = Float64Array.from([0, 0, 0, 4, 0, 0, 0, 3, 0]);

/** A raster of two triangles a square over a height, without the squares that `isLeftOut` names. */
function raster(
  squares: number,
  side: number,
  height: (x: number, y: number) => number,
  isLeftOut: (i: number, j: number) => boolean = () => false,
): Float64Array {
  const corners: number[] = [];
  const at = (i: number, j: number): number[] => [i * side, j * side, height(i * side, j * side)];
  for (let j = 0; j < squares; ++j)
    for (let i = 0; i < squares; ++i) {
      if (isLeftOut(i, j)) continue;
      const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
      corners.push(...a, ...b, ...d, ...a, ...d, ...c);
    }
  return Float64Array.from(corners);
}

describe('distance from a triangle', () => {
  it.each<[Vec3, number]>([
    [[1, 1, 2], 4],
    [[1, 1, -2], 4],
    [[-3, -4, 0], 25],
    [[2, -1, 0], 1],
    [[4, 3, 0], 5.76],
    [[6, 0, 1], 5],
    [[0, 5, 0], 4],
  ])('of %j is right', (point, square) => {
    expect(squareToTriangle(point, TRIANGLE, 0)).toBeCloseTo(square, 12);
  });

  it('of a triangle without an area is that of its edges', () => {
    const line = Float64Array.from([0, 0, 0, 4, 0, 0, 2, 0, 0]);
    expect(squareToTriangle([3, 2, 0], line, 0)).toBe(4);
    expect(squareToTriangle([7, 0, 0], line, 0)).toBe(9);
  });
});

describe('two meshes', () => {
  const bowl = (x: number, y: number): number => 0.01 * ((x - 8) ** 2 + (y - 8) ** 2);
  const fine = raster(32, 0.5, bowl);

  it('are the same surface if one is coarser within the distance', () => {
    expect(isSameSurface(fine, fine, 1e-6)).toBe(true);
    expect(isSameSurface(fine, raster(4, 4, bowl), 0.5)).toBe(true);
    expect(isSameSurface(fine, raster(1, 16, bowl), 0.5)).toBe(false);
  });

  it('are not if one is moved, has a groove or a hole, or there is none', () => {
    expect(
      isSameSurface(
        fine,
        raster(32, 0.5, (x, y) => bowl(x, y) + 0.6),
        0.5,
      ),
    ).toBe(false);
    const groove = (x: number, y: number): number => bowl(x, y) - (Math.abs(y - 5) < 1 ? 0.8 : 0);
    expect(isSameSurface(fine, raster(32, 0.5, groove), 0.5)).toBe(false);
    const hole = raster(32, 0.5, bowl, (i, j) => i > 10 && i < 14 && j > 10 && j < 14);
    expect(isSameSurface(fine, hole, 0.5)).toBe(false);
    expect(isSameSurface(hole, fine, 0.5)).toBe(false);
    const none = new Float64Array(0);
    expect(isSameSurface(fine, none, 0.5)).toBe(false);
    expect(isSameSurface(none, fine, 0.5)).toBe(false);
    expect(isSameSurface(none, none, 0.5)).toBe(true);
  });
});
