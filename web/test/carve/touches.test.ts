// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Touches } from '../../src/carve/touches';

describe('touches', () => {
  let log: string[];
  let turned: [number, number, number];
  let touches: Touches;

  beforeEach(() => {
    vi.useFakeTimers();
    log = [];
    turned = [0, 0, 1];
    touches = new Touches(
      {
        begin: (x, y) => log.push(`begin ${x},${y}`),
        move: (places) => log.push(`move ${places.map(([x, y]) => `${x},${y}`).join(' ')}`),
        end: () => log.push('end'),
        holdPlane: () => log.push('hold'),
        turn: (dx, dy, closer) => (turned = [turned[0] + dx, turned[1] + dy, turned[2] * closer]),
        pan: (dx, dy) => log.push(`pan ${dx},${dy}`),
        undo: () => log.push('undo'),
        redo: () => log.push('redo'),
      },
      () => Date.now(),
    );
  });
  afterEach(() => vi.useRealTimers());

  it('carves with one finger, from where it was put down', () => {
    touches.down(1, 100, 50);
    expect(log).toEqual([]);
    touches.move(1, [[104, 50]]);
    expect(log).toEqual([]);
    touches.move(1, [
      [112, 50],
      [120, 52],
    ]);
    touches.up(1);
    expect(log).toEqual(['begin 100,50', 'move 112,50 120,52', 'end']);
  });

  it('begins with a finger that rests, and cuts once with one that taps', () => {
    touches.down(1, 10, 10);
    vi.advanceTimersByTime(100);
    expect(log).toEqual(['begin 10,10']);
    touches.up(1);
    touches.down(2, 20, 20);
    touches.up(2);
    vi.advanceTimersByTime(1000);
    expect(log).toEqual(['begin 10,10', 'end', 'begin 20,20', 'end']);
  });

  it('holds the plane under a finger that rests where it began, and only under that', () => {
    touches.down(1, 10, 10);
    vi.advanceTimersByTime(1000);
    touches.move(1, [[40, 10]]);
    touches.up(1);
    expect(log).toEqual(['begin 10,10', 'hold', 'move 40,10', 'end']);
    log = [];
    touches.down(2, 10, 10);
    touches.move(2, [[40, 10]]);
    vi.advanceTimersByTime(1000);
    touches.up(2);
    touches.down(3, 10, 10);
    touches.up(3);
    vi.advanceTimersByTime(1000);
    expect(log).not.toContain('hold');
  });

  it('undoes with a tap of two fingers, redoes with one of three, and cuts with neither', () => {
    touches.down(1, 0, 0);
    touches.down(2, 50, 0);
    touches.up(1);
    touches.up(2);
    expect(log).toEqual(['undo']);
    touches.down(1, 0, 0);
    touches.down(2, 50, 0);
    touches.down(3, 99, 0);
    for (const id of [2, 1, 3]) touches.up(id);
    vi.advanceTimersByTime(1000);
    expect(log).toEqual(['undo', 'redo']);
  });

  it('does not take long or moving fingers for a tap', () => {
    touches.down(1, 0, 0);
    touches.down(2, 50, 0);
    vi.advanceTimersByTime(400);
    touches.up(1);
    touches.up(2);
    touches.down(1, 0, 0);
    touches.down(2, 50, 0);
    touches.move(1, [[0, 30]]);
    touches.up(1);
    touches.up(2);
    expect(log).toEqual([]);
  });

  it('turns and zooms with two fingers', () => {
    touches.down(1, 0, 0);
    touches.down(2, 100, 0);
    touches.move(1, [[-50, 0]]);
    touches.move(2, [[150, 0]]);
    expect(turned[0]).toBeCloseTo(0);
    expect(turned[2]).toBeCloseTo(0.5); // twice as far apart: twice as near
    touches.move(1, [[-50, 40]]);
    touches.move(2, [[150, 40]]);
    expect(turned[1]).toBeCloseTo(40);
  });

  it('pans with three', () => {
    for (const [id, x] of [
      [1, 0],
      [2, 50],
      [3, 99],
    ] as const)
      touches.down(id, x, 0);
    touches.move(3, [[129, 0]]);
    expect(log).toEqual(['pan 10,0']);
  });

  it('ends the stroke when a second finger comes, and begins none with the finger that stays', () => {
    touches.down(1, 0, 0);
    touches.move(1, [[30, 0]]);
    touches.down(2, 80, 0);
    expect(log.at(-1)).toBe('end');
    touches.up(2);
    touches.move(1, [[60, 0]]);
    touches.up(1);
    expect(log).toEqual(['begin 0,0', 'move 30,0', 'end']);
  });

  it('ends the stroke when the browser takes the finger away', () => {
    touches.down(1, 0, 0);
    touches.move(1, [[30, 0]]);
    touches.cancel();
    touches.move(1, [[60, 0]]);
    expect(log).toEqual(['begin 0,0', 'move 30,0', 'end']);
  });
});
