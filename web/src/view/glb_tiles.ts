// SPDX-License-Identifier: Apache-2.0
// Mesh frames: a GLB with one node per tile (server/wire/README.md). Which tile and which version comes from `extras`; node
// names are not used, because GLTFLoader rewrites them.

import * as THREE from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/examples/jsm/libs/meshopt_decoder.module.js';

export interface ParsedTile {
  x: number;
  y: number;
  version: number;
  /** of detail; 0: exact */
  level: number;
  triangles: number;
  /** null: nothing is left of the tile */
  geometry: THREE.BufferGeometry | null;
  matrix: THREE.Matrix4;
}

function tileOf(node: THREE.Object3D): ParsedTile | null {
  const { tile, version, level = 0 } = node.userData as { tile?: unknown; version?: unknown; level?: unknown };
  const isTile = Array.isArray(tile) && tile.length === 2 && tile.every(Number.isInteger) && typeof version === 'number' && typeof level === 'number';
  if (!isTile) return null;
  node.updateWorldMatrix(true, false);
  const mesh = node as THREE.Mesh;
  const geometry = mesh.isMesh ? mesh.geometry : null;
  const corners = geometry ? (geometry.index?.count ?? geometry.getAttribute('position').count) : 0;
  return { x: tile[0], y: tile[1], version, level, triangles: corners / 3, geometry, matrix: node.matrixWorld.clone() };
}

/** Reads the tiles of mesh frames. */
export class TileParser {
  private readonly loader_ = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);

  /** Rejects if the bytes are no GLB, or if a node is not a tile. */
  async parse(glb: Uint8Array): Promise<ParsedTile[]> {
    const buffer = glb.slice().buffer; // GLTFLoader wants a buffer of its own
    const gltf = await this.loader_.parseAsync(buffer, '');
    const tiles: ParsedTile[] = [];
    for (const node of gltf.scene.children) {
      const tile = tileOf(node);
      if (!tile) throw new Error(`node "${node.name}" names no tile and version`);
      tiles.push(tile);
    }
    return tiles;
  }
}
