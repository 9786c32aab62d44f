// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Rest } from '../src/model/rest';
import type { RestFrame } from '../src/model/rest';

function frame(x: number, motions = 5, isFast = false): RestFrame {
  return { eyeMm: [x, 0, 0], distanceMm: 100, motions, isFast };
}

/** Takes a frame every 16 ms. Returns whether the last one rests. */
function hold(rest: Rest, shown: RestFrame, fromMs: number, toMs: number): boolean {
  let isResting = false;
  for (let ms = fromMs; ms <= toMs; ms += 16) isResting = rest.take(shown, ms);
  return isResting;
}

describe('rest', () => {
  it('begins two seconds after the eye and the block have moved last', () => {
    const rest = new Rest();
    expect(hold(rest, frame(100), 0, 1984)).toBe(false);
    expect(rest.take(frame(100), 2000)).toBe(true);
  });

  it('begins although rounding moves the eye a little in each frame', () => {
    const rest = new Rest();
    for (let n = 0; n < 125; ++n) rest.take(frame(100 + 1e-9 * (n % 3)), 16 * n);
    expect(rest.take(frame(100), 2000)).toBe(true);
  });

  it('waits for the block', () => {
    const rest = new Rest();
    hold(rest, frame(100, 5), 0, 1900);
    expect(hold(rest, frame(100, 6), 1910, 3900)).toBe(false);
    expect(rest.take(frame(100, 6), 3910)).toBe(true);
  });

  it('goes on while the block is carved, so that its tiles are sent only once', () => {
    const rest = new Rest();
    hold(rest, frame(100, 5), 0, 2100);
    expect(rest.take(frame(100, 6), 2200)).toBe(true);
  });

  it('ends when the eye has left its place, step by step', () => {
    const rest = new Rest();
    hold(rest, frame(100), 0, 2100);
    expect(rest.take(frame(105), 2200)).toBe(true);
    expect(rest.take(frame(109), 2300)).toBe(false);
    expect(hold(rest, frame(109), 2310, 4200)).toBe(false);
    expect(hold(rest, frame(109), 4210, 4400)).toBe(true);
  });

  it('does not end where the picture moves smoothly with exact tiles', () => {
    const rest = new Rest();
    hold(rest, frame(100), 0, 2100);
    expect(rest.take(frame(300, 5, true), 2200)).toBe(true);
  });

  it('begins again after a reset', () => {
    const rest = new Rest();
    hold(rest, frame(100), 0, 2100);
    rest.reset();
    expect(rest.take(frame(100), 2200)).toBe(false);
  });
});
