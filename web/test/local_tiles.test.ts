// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from 'vitest';
import type { TileTriangles } from '../src/kernel/kernel';
import { tileKey } from '../src/model/tiles';
import { LocalTiles } from '../src/view/local_tiles';
import type { TileView } from '../src/view/tile_view';
import { block, SIDE, tileOf, TILES } from './support/tiles';

const ORIGIN: [number, number, number] = [-20, -20, -12];
const KEY = tileKey(2, 1);

/** A triangle at a height above the block's lowest corner. */
function triangle(height: number): TileTriangles {
  return {
    x: 2,
    y: 1,
    positions: Float32Array.from([16, 8, height, 24, 8, height, 16, 16, height]),
    normals: Float32Array.from([0, 0, 1, 0, 0, 1, 0, 0, 1]),
    index: Uint32Array.from([0, 1, 2]),
    original: new Uint8Array(3),
  };
}

describe('tiles of the copy', () => {
  let view: TileView;
  let local: LocalTiles;
  let hidden: number[];

  beforeEach(() => {
    view = block(() => -1);
    local = new LocalTiles(view);
    local.open();
    hidden = [];
    local.hidden = (keys) => hidden.push(...keys);
  });

  /** The heights that are displayed in the tile. */
  function heights(): number[] {
    const tile = view.tiles().find(({ key }) => key === KEY);
    const position = tile?.geometry.getAttribute('position');
    const at = Array.from({ length: position?.count ?? 0 }, (_, n) => {
      const [z, shift] = [tile!.matrix.elements[10], tile!.matrix.elements[14]];
      return Math.round(100 * (position!.getZ(n) * z + shift)) / 100;
    });
    return [...new Set(at)];
  }

  /** The server's mesh of the tile, with so many motions. */
  function serve(height: number, motions: number): void {
    const tile = { ...tileOf(2, 1, () => height), motions };
    local.set(tile, 2, 1, SIDE);
  }

  it('are displayed until a mesh of the server has the motions that are in them', () => {
    local.cover([triangle(9)], 40n, ORIGIN);
    expect(heights()).toEqual([-3]);
    expect(local.size).toBe(1);
    local.answered(20n, 100);
    serve(-2, 105); // an older state, late
    expect(heights()).toEqual([-3]);
    local.answered(41n, 130);
    expect(heights()).toEqual([-3]);
    serve(-2.9, 129);
    expect(heights()).toEqual([-3]);
    serve(-3.1, 130);
    expect(heights()).toEqual([-3.1]);
    expect([local.size, hidden]).toEqual([0, [KEY]]);
    serve(-5, 140);
    expect(heights()).toEqual([-5]);
    expect(view.tiles()).toHaveLength(TILES * TILES);
  });

  it('are replaced by a mesh that has come before the answer', () => {
    local.cover([triangle(9)], 40n, ORIGIN);
    serve(-3.1, 130);
    expect(heights()).toEqual([-3]);
    local.answered(40n, 130);
    expect(heights()).toEqual([-3.1]);
  });

  it('follow the copy, which has more motions then', () => {
    local.cover([triangle(9)], 40n, ORIGIN);
    local.cover([triangle(8)], 60n, ORIGIN);
    local.answered(50n, 130);
    serve(-3, 130);
    expect(heights()).toEqual([-4]);
    local.clear();
    expect(heights()).toEqual([-3]);
  });

  it('are replaced when the block rests, where the server has sent nothing new', () => {
    local.cover([triangle(9)], 40n, ORIGIN);
    local.settled(500);
    expect(heights()).toEqual([-3]);
    local.answered(40n, 130);
    local.settled(129);
    expect(heights()).toEqual([-3]);
    local.settled(130);
    expect(heights()).toEqual([-1]);
  });

  it('are held while the copy has an undo before the server', () => {
    local.cover([triangle(9)], 40n, ORIGIN);
    local.answered(41n, 130);
    local.hold();
    local.cover([triangle(11)], 41n, ORIGIN);
    serve(-3, 130); // with the stroke
    expect(heights()).toEqual([-1]);
    serve(-1.1, 130); // without it
    expect(heights()).toEqual([-1]);
    local.settled(130);
    expect(heights()).toEqual([-1.1]);
    local.clear();
    local.hold();
    local.cover([triangle(9)], 41n, ORIGIN); // of before the server only was displayed
    expect(heights()).toEqual([-3]);
    local.close();
    local.hold();
    local.cover([triangle(9)], 41n, ORIGIN);
    expect(local.size).toBe(0);
  });

  it("restore the server's tiles, and nothing where the server has none", () => {
    local.cover([triangle(9)], 40n, ORIGIN);
    local.clear();
    expect(heights()).toEqual([-1]);
    local.cover([triangle(9)], 41n, ORIGIN);
    local.remove(KEY);
    expect(heights()).toEqual([-3]);
    local.clear();
    expect(heights()).toEqual([]);
    expect(hidden).toEqual([KEY, KEY]);
  });

  it('come too late with samples that were answered before only the server was displayed', () => {
    local.answered(41n, 130);
    local.clear();
    local.cover([triangle(9)], 41n, ORIGIN);
    expect([local.size, hidden]).toEqual([0, [KEY]]);
    expect(heights()).toEqual([-1]);
    local.clear(); // without an answer since
    local.cover([triangle(9)], 41n, ORIGIN);
    expect(local.size).toBe(0);
    local.cover([triangle(8)], 42n, ORIGIN);
    expect(heights()).toEqual([-4]);
  });

  it('are not displayed while nobody carves: their answer does not come', () => {
    local.cover([triangle(9)], 40n, ORIGIN);
    local.close();
    expect(heights()).toEqual([-1]);
    local.cover([triangle(8)], 41n, ORIGIN);
    expect([local.size, hidden]).toEqual([0, [KEY, KEY]]);
    serve(-3.1, 200);
    expect(heights()).toEqual([-3.1]);
    local.open();
    local.cover([triangle(8)], 42n, ORIGIN);
    expect(heights()).toEqual([-4]);
  });
});
