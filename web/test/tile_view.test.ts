// SPDX-License-Identifier: Apache-2.0
import { afterEach, describe, expect, it, vi } from 'vitest';
import * as THREE from 'three';
import { tileKey } from '../src/model/tiles';
import { TileView } from '../src/view/tile_view';
import type { ParsedTile } from '../src/view/parsed_tiles';
import { parsedTiles, triangle } from './support/mesh_frames';
import type { TestTile } from './support/glb.mjs';

/** Displays the only tile of a frame at its place. */
function show(view: TileView, tile: ParsedTile): void {
  for (let y = tile.y; y < tile.y + tile.rows; ++y)
    for (let x = tile.x; x < tile.x + tile.columns; ++x) view.set(tile, x, y, 8);
}

function parsed(tile: TestTile): ParsedTile {
  return parsedTiles([tile])[0]!;
}

const gone = (x: number, y: number): TestTile => ({
  x,
  y,
  version: 9,
  positions: [],
  normals: [],
  indices: [],
});

/** Where the first corner of each tile is drawn, mm. */
function places(view: TileView): string[] {
  const found: string[] = [];
  for (const mesh of view.group.children) {
    if (!(mesh instanceof THREE.InstancedMesh)) throw new Error('not instanced');
    for (let n = 0; n < mesh.count; ++n) {
      const matrix = new THREE.Matrix4();
      mesh.getMatrixAt(n, matrix);
      const geometry = mesh.geometry as THREE.BufferGeometry;
      const corner = geometry.getAttribute('position') as THREE.BufferAttribute;
      const at = new THREE.Vector3().fromBufferAttribute(corner, 0).applyMatrix4(matrix);
      found.push(`${Math.round(at.x)} ${Math.round(at.y)}`);
    }
  }
  return found.sort();
}

/** 0 to count - 1 in an order without pattern, the same in every run. */
function shuffled(count: number): number[] {
  const order = Array.from({ length: count }, (_, n) => n);
  let random = 1;
  for (let n = count - 1; n > 0; --n) {
    random = (random * 48271) % 2147483647;
    const other = random % (n + 1);
    [order[n], order[other]] = [order[other]!, order[n]!];
  }
  return order;
}

describe('tile view', () => {
  afterEach(() => vi.restoreAllMocks());

  it('keeps the right tiles, in whatever order the others are removed and replaced', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const tile = parsed(triangle(0, 0, 1));
    const side = 12;
    const left = new Set<number>();
    const expected = (): string[] =>
      [...left].map((n) => `${8 * (n % side)} ${8 * Math.floor(n / side)}`).sort();
    const set = (n: number): void => {
      view.set(tile, n % side, Math.floor(n / side), 8);
      left.add(n);
    };
    const order = shuffled(side * side);
    for (const n of order) set(n);
    for (const n of shuffled(side * side)) {
      view.remove(tileKey(n % side, Math.floor(n / side)));
      left.delete(n);
      if (n % 3 === 0) set(order[n]!); // displayed or not
      if (n % 16 === 0) expect(places(view)).toEqual(expected());
    }
    for (const n of [...left]) {
      view.remove(tileKey(n % side, Math.floor(n / side)));
      left.delete(n);
      expect(places(view)).toEqual(expected());
    }
    expect(view.group.children).toHaveLength(0);
  });

  it('moves at most one other tile for each that is replaced, and searches none', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const coarse = parsed(triangle(0, 0, 1));
    const fine = parsed(triangle(0, 0, 1, [0, 0, 0, 8, 0, 0, 0, 8, -1]));
    const count = 500;
    for (let x = 0; x < count; ++x) view.set(coarse, x, 0, 8);
    const written = vi.spyOn(THREE.InstancedMesh.prototype, 'setMatrixAt');
    let compared = 0;
    const found = vi.spyOn(Array.prototype, 'indexOf');
    found.mockImplementation(function (this: unknown[], sought: unknown, from = 0) {
      compared += this.length;
      for (let at = from; at < this.length; ++at) if (this[at] === sought) return at;
      return -1;
    });
    for (let x = count - 1; x >= 0; --x) view.set(coarse, x, 0, 8); // a reconnection
    for (let x = 0; x < count; ++x) view.set(fine, x, 0, 8); // another level of detail
    found.mockRestore();
    expect(compared).toBeLessThan(count);
    // Four for a tile and, as three.js writes all places of a batch that has grown, some more.
    expect(written.mock.calls.length).toBeLessThan(10 * count);
    expect(places(view)).toHaveLength(count);
  });

  it('disposes of the geometry of replaced and removed tiles', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const disposed: number[] = [];
    for (const version of [1, 2]) {
      const tile = parsed(triangle(0, 0, version, [0, 0, 0, 8, 0, 0, 0, 8, -version]));
      tile.geometry?.addEventListener('dispose', () => disposed.push(version));
      show(view, tile);
    }
    expect(disposed).toEqual([1]);
    expect(view.group.children).toHaveLength(1);
    show(view, parsed(gone(0, 0)));
    expect(disposed).toEqual([1, 2]);
    expect(view.group.children).toHaveLength(0);
  });

  it('draws tiles of the same shape in one call, in whatever frames they come', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    for (const x of [0, 1, 2, 3]) show(view, parsed(triangle(x, 0, 1)));
    expect(view.shapes).toBe(1);
    expect(places(view)).toEqual(['0 0', '16 0', '24 0', '8 0']);
    show(view, parsed(triangle(1, 0, 2, [0, 0, 0, 8, 0, 0, 0, 8, -1])));
    expect(view.shapes).toBe(2);
    expect(places(view)).toEqual(['0 0', '16 0', '24 0', '8 0']);
    view.remove(tileKey(0, 0)); // the last instance takes its place
    expect(places(view)).toEqual(['16 0', '24 0', '8 0']);
    view.remove(tileKey(2, 0)); // that instance
    expect(places(view)).toEqual(['24 0', '8 0']);
    for (const x of [1, 3]) view.remove(tileKey(x, 0));
    expect(view.group.children).toHaveLength(0);
  });

  it('displays all tiles that one node stands for, and replaces one of them', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const tile = parsed({ ...triangle(1, 2, 1), repeat: [2, 3] });
    expect([tile.columns, tile.rows]).toEqual([2, 3]);
    show(view, tile);
    expect(view.shapes).toBe(1);
    const all = ['8 0', '8 8', '8 16', '16 0', '16 8', '16 16'].sort();
    expect(places(view)).toEqual(all);
    show(view, parsed(gone(2, 3)));
    expect(places(view)).toEqual(all.filter((at) => at !== '16 8'));
  });
});
