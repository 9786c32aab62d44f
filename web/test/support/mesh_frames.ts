// SPDX-License-Identifier: Apache-2.0
// Mesh frames of triangles, and what the page makes of them.

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

export function parsedTiles(tiles: TestTile[]): ParsedTile[] {
  return tilesOf(readMeshGlb(writeMeshGlb(tiles, STEP_MM, 0, 1), NO_DECODER));
}
