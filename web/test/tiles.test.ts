// SPDX-License-Identifier: Apache-2.0
import { effect } from '@preact/signals';
import { describe, expect, it } from 'vitest';
import { TileTable } from '../src/model/tiles';

function table(): TileTable {
  const tiles = new TileTable();
  tiles.beginSnapshot();
  return tiles;
}

describe('tiles', () => {
  it('keeps the newest version in any order of arrival', () => {
    const tiles = table();
    expect(tiles.offer(1, 2, 5, 100)).toBe(true);
    expect(tiles.offer(1, 2, 4, 90)).toBe(false);
    expect(tiles.offer(1, 2, 6, 70)).toBe(true);
    expect(tiles.version(1, 2)).toBe(6);
    expect(tiles.triangles).toBe(70);
  });

  it('reaches the same state for every order of the same frames', () => {
    type Offer = [x: number, y: number, version: number, triangles: number];
    const offers: Offer[] = [
      [0, 0, 1, 10],
      [0, 0, 2, 20],
      [0, 1, 1, 30],
      [0, 0, 3, 0],
      [0, 1, 7, 5],
    ];
    const results = new Set<string>();
    const permute = (rest: Offer[], done: Offer[]): void => {
      if (rest.length === 0) {
        const tiles = table();
        for (const offer of done) tiles.offer(...offer);
        results.add(JSON.stringify([tiles.list(), tiles.triangles]));
      }
      rest.forEach((offer, i) =>
        permute(
          rest.filter((_, k) => k !== i),
          [...done, offer],
        ),
      );
    };
    permute(offers, []);
    expect(results.size).toBe(1);
  });

  it('replaces a tile by another level of the same version', () => {
    const tiles = table();
    tiles.offer(1, 2, 5, 100);
    expect(tiles.offer(1, 2, 5, 30, 2)).toBe(true);
    expect(tiles.list()).toMatchObject([{ version: 5, level: 2, triangles: 30 }]);
    expect(tiles.offer(1, 2, 5, 100, 0)).toBe(true);
    expect(tiles.triangles).toBe(100);
  });

  it('distinguishes tiles (1, 11) and (11, 1)', () => {
    const tiles = table();
    expect(tiles.offer(1, 11, 1, 1)).toBe(true);
    expect(tiles.offer(11, 1, 1, 2)).toBe(true);
    expect(tiles.size).toBe(2);
    expect(tiles.triangles).toBe(3);
  });

  it('accepts lower versions after a reconnection, because the server may have restarted', () => {
    const tiles = table();
    tiles.offer(0, 0, 9, 50);
    tiles.finishSnapshot();
    tiles.beginSnapshot();
    expect(tiles.complete).toBe(false);
    expect(tiles.offer(0, 0, 1, 40)).toBe(true);
    expect(tiles.triangles).toBe(40);
  });

  it('keeps old tiles until the new snapshot is complete, then removes those not in it', () => {
    const tiles = table();
    tiles.offer(0, 0, 1, 10);
    tiles.offer(5, 0, 1, 20);
    expect(tiles.finishSnapshot()).toEqual([]);
    tiles.beginSnapshot();
    tiles.offer(0, 0, 1, 11);
    expect(tiles.size).toBe(2);
    expect(tiles.finishSnapshot()).toHaveLength(1);
    expect(tiles.list()).toMatchObject([{ x: 0, y: 0, triangles: 11 }]);
    expect(tiles.triangles).toBe(11);
    expect(tiles.complete).toBe(true);
  });

  it('tells when it becomes exact and when it is no longer', () => {
    const tiles = new TileTable();
    const heard: boolean[] = [];
    const stop = effect(() => void heard.push(tiles.exact));
    heard.length = 0; // without the state now
    tiles.beginSnapshot();
    tiles.offer(0, 0, 1, 10, 2);
    tiles.offer(1, 0, 1, 10, 1);
    tiles.finishSnapshot();
    tiles.offer(0, 0, 1, 40, 0);
    expect(heard).toEqual([]);
    tiles.offer(1, 0, 1, 40, 0);
    tiles.offer(1, 0, 1, 20, 1);
    expect(heard).toEqual([true, false]);
    tiles.beginSnapshot();
    tiles.offer(0, 0, 1, 40, 0);
    tiles.finishSnapshot(); // without the coarse one
    expect(heard).toEqual([true, false, true]);
    stop();
    tiles.offer(0, 0, 2, 20, 1);
    expect(tiles.exact).toBe(false);
    expect(heard).toHaveLength(3);
  });
});
