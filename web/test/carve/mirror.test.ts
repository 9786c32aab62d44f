// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { imagesOf, middleOf, nextMirror } from '../../src/carve/mirror';
import type { Stock, Vec3 } from '../../src/wire/types';

const POSE = { tip: [3, 1, 2] as Vec3, axis: [0.6, 0, 0.8] as Vec3 };

describe('a mirror', () => {
  it('is in the middle of the block, on its grid of half pitches', () => {
    for (const [size, pitch] of [
      [40, 0.25],
      [33.3, 0.4],
      [7.77, 0.3],
    ] as const) {
      const stock: Stock = { shape: 'box', min_mm: [-5, 2, 0], max_mm: [size - 5, size + 2, size] };
      middleOf({ stock, pitch_mm: pitch }).forEach((at, n) => {
        const from = stock.min_mm[n]!;
        expect(Math.abs(at - from - size / 2)).toBeLessThanOrEqual(pitch / 4 + 1e-9);
        const columns = (2 * (at - from)) / pitch;
        expect(columns).toBeCloseTo(Math.round(columns), 9);
      });
    }
  });

  it('reflects tip and axis across one plane', () => {
    const images = (['x', 'y', 'z'] as const).map((axis) => imagesOf(axis, [1, 2, 3])[0]!(POSE));
    expect(images).toEqual([
      { tip: [-1, 1, 2], axis: [-0.6, 0, 0.8] },
      { tip: [3, 3, 2], axis: [0.6, -0, 0.8] },
      { tip: [3, 1, 4], axis: [0.6, 0, -0.8] },
    ]);
    expect(imagesOf('off', [0, 0, 0])).toEqual([]);
  });

  it('turns around the vertical axis, and quarters exactly', () => {
    const images = imagesOf(4, [1, 1, 9]).map((image) => image(POSE));
    expect(images.map(({ tip }) => tip)).toEqual([
      [1, 3, 2],
      [-1, 1, 2],
      [1, -1, 2],
    ]);
    expect(images[0]!.axis).toEqual([0, 0.6, 0.8]);
    expect(imagesOf(12, [0, 0, 0])).toHaveLength(11);
  });

  it('is chosen in turn, with the turns that were chosen last', () => {
    const seen = ['off'] as (string | number)[];
    let mirror = nextMirror('off', 6);
    while (mirror !== 'off') {
      seen.push(mirror);
      mirror = nextMirror(mirror, 6);
    }
    expect(seen).toEqual(['off', 'x', 'y', 'z', 6]);
  });
});
