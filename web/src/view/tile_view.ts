// SPDX-License-Identifier: Apache-2.0
// The block's surface: one mesh per tile. Tiles are replaced as a whole; the old tile's GPU buffers
// are released immediately.

import * as THREE from 'three';
import { tileKey } from '../model/tiles';
import type { ParsedTile } from './glb_tiles';

export class TileView {
  readonly group = new THREE.Group();
  private readonly meshes_ = new Map<number, THREE.Mesh>();

  constructor(private readonly material: THREE.Material) {
    this.group.matrixAutoUpdate = false;
  }

  set(tile: ParsedTile): void {
    const key = tileKey(tile.x, tile.y);
    if (!tile.geometry) {
      this.remove(key);
      return;
    }
    let mesh = this.meshes_.get(key);
    if (mesh) {
      mesh.geometry.dispose();
      mesh.geometry = tile.geometry;
    } else {
      mesh = new THREE.Mesh(tile.geometry, this.material);
      mesh.matrixAutoUpdate = false;
      mesh.castShadow = true;
      mesh.receiveShadow = true;
      this.meshes_.set(key, mesh);
      this.group.add(mesh);
    }
    mesh.matrix.copy(tile.matrix);
    mesh.matrixWorldNeedsUpdate = true;
  }

  remove(key: number): void {
    const mesh = this.meshes_.get(key);
    if (!mesh) return;
    this.group.remove(mesh);
    mesh.geometry.dispose();
    this.meshes_.delete(key);
  }

  /** Returns the first intersection of a ray with the block, or null. */
  pick(raycaster: THREE.Raycaster): THREE.Vector3 | null {
    return raycaster.intersectObjects([...this.meshes_.values()], false)[0]?.point ?? null;
  }
}
