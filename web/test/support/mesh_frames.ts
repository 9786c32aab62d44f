// SPDX-License-Identifier: Apache-2.0
// Mesh frames of triangles, and the tiles that the page makes of them.

import { readMeshGlb } from '../../src/decode/mesh_glb';
import type { BufferDecoder } from '../../src/decode/mesh_glb';
import { tilesOf } from '../../src/view/parsed_tiles';
import type { ParsedTile } from '../../src/view/parsed_tiles';
import { writeMeshGlb } from './glb.mjs';
import type { TestTile } from './glb.mjs';

export const STEP_MM = 1 / 512;

/** Nothing in these frames is compressed. */
export const NO_DECODER: BufferDecoder = {
  decodeGltfBuffer: () => {
    throw new Error('a compressed view');
  },
};

export function triangle(
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

/** A surface of waves over a raster, of which every third vertex is original. */
export function waves(x: number, y: number, raster: number): TestTile {
  const tile: TestTile = { x, y, version: 3, positions: [], normals: [], indices: [] };
  tile.original = [];
  for (let j = 0; j <= raster; ++j)
    for (let i = 0; i <= raster; ++i) {
      const slope = 0.3 * Math.cos(i);
      const length = Math.hypot(slope, 1);
      tile.positions.push(8 * x + (8 * i) / raster, 8 * y + (8 * j) / raster, 0.3 * Math.sin(i));
      tile.normals.push(-slope / length, 0, 1 / length);
      tile.original.push(j % 3 === 0 ? 1 : 0);
    }
  for (let j = 0; j < raster; ++j)
    for (let i = 0; i < raster; ++i) {
      const a = j * (raster + 1) + i;
      tile.indices.push(a, a + 1, a + raster + 2, a, a + raster + 2, a + raster + 1);
    }
  return tile;
}

export function parsedTiles(tiles: TestTile[]): ParsedTile[] {
  return tilesOf(readMeshGlb(writeMeshGlb(tiles, STEP_MM, 0, 1), NO_DECODER));
}
