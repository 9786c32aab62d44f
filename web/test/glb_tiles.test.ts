// SPDX-License-Identifier: Apache-2.0
import { beforeAll, describe, expect, it } from 'vitest';
import * as THREE from 'three';
import { TileParser } from '../src/view/glb_tiles';
import { TileView } from '../src/view/tile_view';
import { tileKey } from '../src/model/tiles';
import { writeMeshGlb } from './support/glb.mjs';
import type { TestTile } from './support/glb.mjs';

beforeAll(() => {
  // GLTFLoader reads this browser global even for files without images.
  Object.assign(globalThis, { self: globalThis });
});

const STEP_MM = 1 / 512;

function triangle(
  x: number,
  y: number,
  version: number,
  corners: number[] = [0, 0, 0, 8, 0, 0, 0, 8, -3],
): TestTile {
  return {
    x,
    y,
    version,
    positions: corners.map((v, i) => v + (i % 3 === 0 ? 8 * x : 0)),
    normals: [0, 0, 1, 0, 0, 1, 0, 0, 1],
    indices: [0, 1, 2],
  };
}

const parser = new TileParser();

describe('mesh frames', () => {
  it('contain tiles with their versions and vertices in world coordinates', async () => {
    const tiles = await parser.parse(
      writeMeshGlb([triangle(1, 11, 4), triangle(11, 1, 7)], STEP_MM, 0, 1),
    );
    expect(tiles.map(({ x, y, version, triangles }) => [x, y, version, triangles])).toEqual([
      [1, 11, 4, 1],
      [11, 1, 7, 1],
    ]);
    const first = tiles[0]!;
    const position = first.geometry?.getAttribute('position') as THREE.BufferAttribute;
    const corner = new THREE.Vector3().fromBufferAttribute(position, 2).applyMatrix4(first.matrix);
    expect(corner.x).toBeCloseTo(8, 3);
    expect(corner.y).toBeCloseTo(8, 3);
    expect(corner.z).toBeCloseTo(-3, 3);
  });

  it('may contain an empty tile', async () => {
    const gone = { x: 2, y: 3, version: 9, positions: [], normals: [], indices: [] };
    const tiles = await parser.parse(writeMeshGlb([gone], STEP_MM, 0, 1));
    expect(tiles).toMatchObject([{ x: 2, y: 3, version: 9, triangles: 0, geometry: null }]);
  });

  it('are rejected if they are not a GLB', async () => {
    await expect(parser.parse(new Uint8Array([1, 2, 3, 4]))).rejects.toThrow();
  });
});

describe('tile view', () => {
  it('disposes of the geometry of replaced and removed tiles', async () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const disposed: number[] = [];
    for (const version of [1, 2]) {
      const [tile] = await parser.parse(writeMeshGlb([triangle(0, 0, version)], STEP_MM, 0, 1));
      tile?.geometry?.addEventListener('dispose', () => disposed.push(version));
      if (tile) view.set(tile);
    }
    expect(disposed).toEqual([1]);
    expect(view.group.children).toHaveLength(1);
    view.set({
      x: 0,
      y: 0,
      version: 3,
      level: 0,
      triangles: 0,
      geometry: null,
      matrix: new THREE.Matrix4(),
    });
    expect(disposed).toEqual([1, 2]);
    expect(view.group.children).toHaveLength(0);
  });

  it('keeps a geometry that tiles share until the last one is gone', () => {
    const view = new TileView(new THREE.MeshBasicMaterial());
    const geometry = new THREE.BufferGeometry();
    let disposed = 0;
    geometry.addEventListener('dispose', () => (disposed += 1));
    const tile = (x: number) => ({
      x,
      y: 0,
      version: 1,
      level: 0,
      triangles: 2,
      geometry,
      matrix: new THREE.Matrix4(),
    });
    view.set(tile(0));
    view.set(tile(1));
    view.set({ ...tile(0), version: 2, geometry: new THREE.BufferGeometry() });
    expect(disposed).toBe(0);
    view.remove(tileKey(1, 0));
    expect(disposed).toBe(1);
  });
});
