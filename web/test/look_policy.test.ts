// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { errorRad, LookPolicy } from '../src/model/look_policy';
import type { Look } from '../src/wire/types';

function from(x: number, error_rad = 0.001): Look {
  return { eye_mm: [x, 0, 0], error_rad };
}

describe('look policy', () => {
  it('allows half a pixel of the picture, however many of them make a CSS pixel', () => {
    const cssPixel = (2 * Math.tan(Math.PI / 12)) / 1000; // 30° over 1000 of them
    expect(errorRad(1000, 1)).toBeCloseTo(0.5 * cssPixel, 12);
    expect(errorRad(500, 1)).toBeCloseTo(2 * 0.5 * cssPixel, 12);
    expect(errorRad(1000, 2)).toBeCloseTo(0.25 * cssPixel, 12);
    expect(errorRad(1000, 3)).toBe(errorRad(1000, 2)); // no picture has more than two
  });

  it('sends the first look immediately, and again after a reset', () => {
    const policy = new LookPolicy();
    expect(policy.next(from(100), 100, 0)).toEqual(from(100));
    expect(policy.next(from(100), 100, 1)).toBeNull();
    policy.reset();
    expect(policy.next(from(100), 100, 2)).toEqual(from(100));
  });

  it('waits until the camera rests', () => {
    const policy = new LookPolicy();
    policy.next(from(100), 100, 0);
    expect(policy.next(from(150), 150, 100)).toBeNull();
    expect(policy.next(from(160), 160, 200)).toBeNull();
    expect(policy.next(from(160), 160, 440)).toBeNull();
    expect(policy.next(from(160), 160, 460)).toEqual(from(160));
  });

  it('sends once a second while the camera moves', () => {
    const policy = new LookPolicy();
    policy.next(from(100), 100, 0);
    let sent = 0;
    for (let ms = 16; ms <= 3300; ms += 16)
      sent += policy.next(from(100 + ms), 100 + ms, ms) ? 1 : 0;
    expect(sent).toBe(3);
  });

  it('ignores small movements but sends a changed error', () => {
    const policy = new LookPolicy();
    policy.next(from(100), 100, 0);
    expect(policy.next(from(105), 105, 1000)).toBeNull();
    expect(policy.next(from(105), 105, 2000)).toBeNull();
    expect(policy.next(from(105, 0.0012), 105, 3000)).toEqual(from(105, 0.0012));
  });
});
