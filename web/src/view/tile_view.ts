// SPDX-License-Identifier: Apache-2.0
// The block's surface: one mesh per tile. Tiles are replaced as a whole; the old tile's GPU buffers
// are released as soon as no tile uses them.

import * as THREE from 'three';
import { tileKey } from '../model/tiles';
import type { ParsedTile } from './glb_tiles';

export class TileView {
  readonly group = new THREE.Group();
  private readonly meshes_ = new Map<number, THREE.Mesh>();
  /** Number of displayed tiles by geometry: those of equal shape share one. */
  private readonly users_ = new Map<THREE.BufferGeometry, number>();

  constructor(private readonly material: THREE.Material) {
    this.group.matrixAutoUpdate = false;
  }

  /** Returns a tile that is not displayed, by which shaders can be compiled. */
  sample(): THREE.Mesh {
    const mesh = new THREE.Mesh(new THREE.PlaneGeometry(), this.material);
    mesh.castShadow = true;
    mesh.receiveShadow = true;
    return mesh;
  }

  set(tile: ParsedTile): void {
    const key = tileKey(tile.x, tile.y);
    if (!tile.geometry) {
      this.remove(key);
      return;
    }
    let mesh = this.meshes_.get(key);
    this.users_.set(tile.geometry, (this.users_.get(tile.geometry) ?? 0) + 1);
    if (mesh) {
      this.release_(mesh.geometry);
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
    this.release_(mesh.geometry);
    this.meshes_.delete(key);
  }

  private release_(geometry: THREE.BufferGeometry): void {
    const left = (this.users_.get(geometry) ?? 0) - 1;
    if (left > 0) {
      this.users_.set(geometry, left);
    } else {
      this.users_.delete(geometry);
      geometry.dispose();
    }
  }

  /** Returns the first intersection of a ray with the block, or null. */
  pick(raycaster: THREE.Raycaster): THREE.Vector3 | null {
    return raycaster.intersectObjects([...this.meshes_.values()], false)[0]?.point ?? null;
  }
}
