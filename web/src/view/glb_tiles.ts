// SPDX-License-Identifier: Apache-2.0
// Parses mesh frames: a GLB with one node per tile (server/wire/README.md). Tile and version come
// from `extras`, not from node names, because GLTFLoader rewrites those.

import * as THREE from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';

/** A tile, or a rectangle of tiles that differ in their places only, from x, y up. */
export interface ParsedTile {
  x: number;
  y: number;
  columns: number;
  rows: number;
  version: number;
  /** Level of detail; 0 is exact. */
  level: number;
  triangles: number;
  /** Motions of the block that are in it. */
  motions: number;
  /** Equal for tiles of the same shape. */
  shape: string;
  /** null if no material is left in the tile */
  geometry: THREE.BufferGeometry | null;
  matrix: THREE.Matrix4;
}

/** Of a vertex: 1 where the surface is that of the untouched stock, 0 where it was cut. */
export const ORIGINAL_ATTRIBUTE = 'stockOriginal';

/** Gives the fourth byte of each normal a name of its own. */
function nameOriginal(geometry: THREE.BufferGeometry): void {
  const normal = geometry.getAttribute('normal');
  if (!(normal instanceof THREE.InterleavedBufferAttribute)) return;
  const original = new THREE.InterleavedBufferAttribute(normal.data, 1, 3);
  geometry.setAttribute(ORIGINAL_ATTRIBUTE, original);
}

function isCoordinatePair(value: unknown): value is [x: number, y: number] {
  return Array.isArray(value) && value.length === 2 && value.every(Number.isInteger);
}

/**
 * Returns a text that is equal for equal geometries, and different for others with a probability of
 * 2^-64: two hashes (FNV-1a with different primes) of positions, normals and indices.
 */
function shapeOf(geometry: THREE.BufferGeometry): string {
  let one = 0x811c9dc5;
  let other = 0x9747b28c;
  const mix = (word: number): void => {
    one = Math.imul(one ^ word, 0x01000193);
    other = Math.imul(other ^ word, 0x5bd1e995);
    other ^= other >>> 15;
  };
  const { position, normal } = geometry.attributes;
  for (const attribute of [position, normal, geometry.index]) {
    if (!attribute) continue;
    const array = 'data' in attribute ? attribute.data.array : attribute.array;
    mix(array.length);
    for (const word of array) mix(word);
  }
  return `${one >>> 0} ${other >>> 0}`;
}

function tileOf(node: THREE.Object3D, motions: number): ParsedTile | null {
  const { tile, version, level = 0, repeat = [1, 1] } = node.userData as Record<string, unknown>;
  if (
    !isCoordinatePair(tile) ||
    !isCoordinatePair(repeat) ||
    typeof version !== 'number' ||
    typeof level !== 'number'
  )
    return null;
  node.updateWorldMatrix(true, false);
  const geometry = node instanceof THREE.Mesh ? (node as THREE.Mesh).geometry : null;
  if (geometry) nameOriginal(geometry);
  const corners = geometry ? (geometry.index?.count ?? geometry.getAttribute('position').count) : 0;
  return {
    x: tile[0],
    y: tile[1],
    columns: repeat[0],
    rows: repeat[1],
    version,
    level,
    triangles: corners / 3,
    motions,
    shape: geometry ? shapeOf(geometry) : '',
    geometry,
    matrix: node.matrixWorld.clone(),
  };
}

/** Parses the tiles of mesh frames. */
export class TileParser {
  private readonly loader_ = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);

  /** Rejects if the bytes are not a GLB, or if a node is not a tile. */
  async parse(glb: Uint8Array): Promise<ParsedTile[]> {
    const buffer = glb.slice().buffer; // GLTFLoader requires a separate ArrayBuffer
    const gltf = await this.loader_.parseAsync(buffer, '');
    const { to } = gltf.scene.userData;
    const motions = typeof to === 'number' ? to : 0;
    const tiles: ParsedTile[] = [];
    for (const node of gltf.scene.children) {
      const tile = tileOf(node, motions);
      if (!tile) throw new Error(`node "${node.name}" has no valid tile, version or level`);
      tiles.push(tile);
    }
    return tiles;
  }
}
