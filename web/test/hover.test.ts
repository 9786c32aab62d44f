// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Hover } from '../src/model/hover';

describe('the place under the pointer', () => {
  it('is asked about once, when the pointer has rested', () => {
    const hover = new Hover();
    expect(hover.due('a', 0)).toBeNull();
    for (let x = 0; x < 100; x += 10) {
      hover.move({ x, y: 0 }, x);
      expect(hover.due('a', x)).toBeNull();
    }
    expect(hover.due('a', 239)).toBeNull();
    const place = hover.due('a', 240);
    expect(place).toEqual({ x: 90, y: 0 });
    expect(hover.answered(place!)).toBe(true);
    expect(hover.due('a', 60_000)).toBeNull();
  });

  it('stays the same while the hand trembles', () => {
    const hover = new Hover();
    expect(hover.move({ x: 5, y: 5 }, 0)).toBe(true);
    expect(hover.move({ x: 7, y: 5 }, 100)).toBe(false);
    expect(hover.due('a', 150)).toEqual({ x: 5, y: 5 });
    expect(hover.move({ x: 8, y: 5 }, 160)).toBe(true);
  });

  it('is asked about by one request at a time, whose late answer is not of the next place', () => {
    const hover = new Hover();
    hover.move({ x: 0, y: 0 }, 0);
    const first = hover.due('a', 200)!;
    hover.move({ x: 50, y: 0 }, 300);
    expect(hover.due('a', 900)).toBeNull();
    expect(hover.answered(first)).toBe(false);
    expect(hover.due('a', 900)).toEqual({ x: 50, y: 0 });
  });

  it('is asked about again when the surface has changed, at most once a second', () => {
    const hover = new Hover();
    hover.move({ x: 0, y: 0 }, 0);
    hover.answered(hover.due('a', 200)!);
    expect(hover.due('b', 1199)).toBeNull();
    const again = hover.due('b', 1200);
    expect(again).not.toBeNull();
    expect(hover.answered(again!)).toBe(true);
    expect(hover.due('b', 9000)).toBeNull();
  });

  it('is asked about at once by a press', () => {
    const hover = new Hover();
    hover.press({ x: 3, y: 4 });
    expect(hover.due('a', 0)).toEqual({ x: 3, y: 4 });
  });

  it('is another one when the picture has moved', () => {
    const hover = new Hover();
    hover.move({ x: 3, y: 4 }, 0);
    const before = hover.due('a', 200)!;
    hover.restart(300);
    expect(hover.answered(before)).toBe(false);
    expect(hover.due('a', 449)).toBeNull();
    expect(hover.due('a', 450)).toEqual(before);
  });

  it('is of no interest once the pointer has left', () => {
    const hover = new Hover();
    hover.move({ x: 3, y: 4 }, 0);
    const place = hover.due('a', 200)!;
    hover.leave();
    expect(hover.answered(place)).toBe(false);
    hover.restart(300);
    expect(hover.due('a', 9000)).toBeNull();
    expect(hover.place).toBeNull();
  });
});
