// SPDX-License-Identifier: Apache-2.0
// The tiles of a decoded mesh frame as geometries of three.js.

import * as THREE from 'three';
import type { MeshFrame, TileShape, VertexValues } from '../decode/mesh_glb';

/** A tile, or a rectangle of tiles that differ in their places only, from x, y up. */
export interface ParsedTile {
  x: number;
  y: number;
  columns: number;
  rows: number;
  version: number;
  /** Level of detail; 0 is exact. */
  level: number;
  digest?: string;
  triangles: number;
  /** Motions of the block that are in it. */
  motions: number;
  /** null if no material is left in the tile */
  geometry: THREE.BufferGeometry | null;
  matrix: THREE.Matrix4;
}

/** Of a vertex: 1 where the surface is that of the untouched stock, 0 where it was cut. */
export const ORIGINAL_ATTRIBUTE = 'stockOriginal';

function bufferOf({ array, stride }: VertexValues): THREE.InterleavedBuffer {
  return new THREE.InterleavedBuffer(array, stride);
}

function geometryOf({ positions, normals, index }: TileShape): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  const [places, directions] = [bufferOf(positions), bufferOf(normals)];
  const attribute = (
    name: string,
    buffer: THREE.InterleavedBuffer,
    values: number,
    first: number,
    isNormalized: boolean,
  ): void => {
    const read = new THREE.InterleavedBufferAttribute(buffer, values, first, isNormalized);
    geometry.setAttribute(name, read);
  };
  attribute('position', places, 3, 0, positions.isNormalized);
  attribute('normal', directions, 3, 0, normals.isNormalized);
  attribute(ORIGINAL_ATTRIBUTE, directions, 1, 3, false);
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  return geometry;
}

export function tilesOf({ motions, nodes, shapes }: MeshFrame): ParsedTile[] {
  const geometries = shapes.map(geometryOf);
  return nodes.map(({ shape, scale, translation, ...tile }) => {
    const made = shape === null ? null : shapes[shape]!;
    return {
      ...tile,
      motions,
      triangles: (made?.index.length ?? 0) / 3,
      geometry: shape === null ? null : geometries[shape]!,
      matrix: new THREE.Matrix4()
        .makeTranslation(...translation)
        .scale(new THREE.Vector3(...scale)),
    };
  });
}
