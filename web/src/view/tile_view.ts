// SPDX-License-Identifier: Apache-2.0
// The block's surface. Tiles of the same shape, such as the untouched ones of a box, are instances of
// one mesh: one draw call, however many frames they came in. Tiles are replaced as a whole; the GPU
// buffers of a shape are released with its last tile.

import * as THREE from 'three';
import { tileAt, tileKey } from '../model/tiles';
import { ORIGINAL_ATTRIBUTE } from './parsed_tiles';
import type { ParsedTile } from './parsed_tiles';

/** A displayed tile. */
export interface DisplayedTile {
  key: number;
  geometry: THREE.BufferGeometry;
  matrix: THREE.Matrix4;
}

/** The tiles of one shape. */
class Batch {
  mesh: THREE.InstancedMesh;
  private readonly keys_: number[] = []; // of the instances, in their order
  private readonly at_ = new Map<number, number>(); // the instance of a key

  constructor(
    readonly shape: string,
    geometry: THREE.BufferGeometry,
    material: THREE.Material,
    private readonly group: THREE.Group,
  ) {
    this.mesh = this.make_(geometry, material, 1);
  }

  get size(): number {
    return this.keys_.length;
  }

  add(key: number, matrix: THREE.Matrix4): void {
    if (this.size === this.mesh.instanceMatrix.count) this.grow_();
    this.mesh.setMatrixAt(this.size, matrix);
    this.at_.set(key, this.size);
    this.keys_.push(key);
    this.changed_();
  }

  /** The last tile takes the place of the one that leaves. */
  remove(key: number): void {
    const at = this.at_.get(key)!;
    const last = this.keys_.pop()!;
    this.at_.delete(key);
    if (at < this.size) {
      const matrix = new THREE.Matrix4();
      this.mesh.getMatrixAt(this.size, matrix);
      this.mesh.setMatrixAt(at, matrix);
      this.keys_[at] = last;
      this.at_.set(last, at);
    }
    this.changed_();
  }

  matrixOf(key: number): THREE.Matrix4 {
    const matrix = new THREE.Matrix4();
    this.mesh.getMatrixAt(this.at_.get(key)!, matrix);
    return matrix;
  }

  tiles(): DisplayedTile[] {
    return this.keys_.map((key, at) => {
      const matrix = new THREE.Matrix4();
      this.mesh.getMatrixAt(at, matrix);
      return { key, geometry: this.mesh.geometry, matrix };
    });
  }

  dispose(): void {
    this.group.remove(this.mesh);
    this.mesh.geometry.dispose();
    this.mesh.dispose();
  }

  private changed_(): void {
    this.mesh.count = this.size;
    this.mesh.instanceMatrix.needsUpdate = true;
    this.mesh.boundingSphere = null; // computed again when it is needed
  }

  private grow_(): void {
    const { geometry, material, instanceMatrix } = this.mesh;
    const old = this.mesh;
    this.mesh = this.make_(geometry, material as THREE.Material, 4 * this.size);
    this.mesh.instanceMatrix.array.set(instanceMatrix.array);
    this.group.remove(old);
    old.dispose();
  }

  private make_(
    geometry: THREE.BufferGeometry,
    material: THREE.Material,
    capacity: number,
  ): THREE.InstancedMesh {
    const mesh = new THREE.InstancedMesh(geometry, material, capacity);
    mesh.matrixAutoUpdate = false;
    mesh.castShadow = true;
    mesh.receiveShadow = true;
    this.group.add(mesh);
    return mesh;
  }
}

export class TileView {
  readonly group = new THREE.Group();
  /** Counts up whenever the surface changes. */
  changes = 0;
  private readonly batches_ = new Map<string, Batch>();
  private readonly batchOf_ = new Map<number, Batch>();

  constructor(private readonly material: THREE.Material) {
    this.group.matrixAutoUpdate = false;
  }

  /** Number of distinct shapes, each of which is a draw call. */
  get shapes(): number {
    return this.batches_.size;
  }

  /** Returns a tile that is not displayed, by which shaders can be compiled. */
  sample(): THREE.Mesh {
    const mesh = new THREE.InstancedMesh(new THREE.PlaneGeometry(), this.material, 1);
    mesh.castShadow = true;
    mesh.receiveShadow = true;
    return mesh;
  }

  /** Displays the tile at x, y of those that `tile` stands for, whose sides have `sideMm`. */
  set(tile: ParsedTile, x: number, y: number, sideMm: number): void {
    const key = tileKey(x, y);
    this.changes += 1;
    if (!tile.geometry) {
      this.remove(key);
      return;
    }
    const batch = this.batch_(tile.shape, tile.geometry);
    if (this.batchOf_.get(key) !== batch) this.remove(key);
    else batch.remove(key);
    const matrix = new THREE.Matrix4().makeTranslation(
      (x - tile.x) * sideMm,
      (y - tile.y) * sideMm,
      0,
    );
    batch.add(key, matrix.multiply(tile.matrix));
    this.batchOf_.set(key, batch);
  }

  remove(key: number): void {
    const batch = this.batchOf_.get(key);
    if (!batch) return;
    this.changes += 1;
    this.batchOf_.delete(key);
    batch.remove(key);
    if (batch.size > 0) return;
    this.batches_.delete(batch.shape);
    batch.dispose();
  }

  /** The tile that is displayed at a key, as it would be set again; null: none. */
  get(key: number): ParsedTile | null {
    const batch = this.batchOf_.get(key);
    if (!batch) return null;
    const [x, y] = tileAt(key);
    const { geometry } = batch.mesh;
    const matrix = batch.matrixOf(key);
    const one = { columns: 1, rows: 1, version: 0, level: 0, motions: 0, triangles: 0 };
    return { x, y, ...one, shape: batch.shape, geometry, matrix };
  }

  tiles(): DisplayedTile[] {
    return [...this.batches_.values()].flatMap((batch) => batch.tiles());
  }

  /** Returns what says of a tile's vertices whether they are on the surface of the untouched stock. */
  originalOf({ geometry }: DisplayedTile): (vertex: number) => boolean {
    const original = geometry.attributes[ORIGINAL_ATTRIBUTE];
    return (vertex) => original !== undefined && original.getX(vertex) > 0.5;
  }

  /** Returns the first intersection of a ray with the block, or null. */
  pick(raycaster: THREE.Raycaster): THREE.Vector3 | null {
    const meshes = [...this.batches_.values()].map(({ mesh }) => mesh);
    return raycaster.intersectObjects(meshes, false)[0]?.point ?? null;
  }

  /** The corners of all triangles, nine numbers each, mm. */
  corners(): number[] {
    const corners: number[] = [];
    const [matrix, at] = [new THREE.Matrix4(), new THREE.Vector3()];
    for (const { mesh } of this.batches_.values()) {
      const { index, attributes } = mesh.geometry;
      const position = attributes['position']!;
      const count = index?.count ?? position.count;
      for (let instance = 0; instance < mesh.count; ++instance) {
        mesh.getMatrixAt(instance, matrix);
        for (let n = 0; n < count; ++n) {
          at.fromBufferAttribute(position, index?.getX(n) ?? n).applyMatrix4(matrix);
          corners.push(at.x, at.y, at.z);
        }
      }
    }
    return corners;
  }

  private batch_(shape: string, geometry: THREE.BufferGeometry): Batch {
    let batch = this.batches_.get(shape);
    if (!batch) {
      batch = new Batch(shape, geometry, this.material, this.group);
      this.batches_.set(shape, batch);
    }
    return batch;
  }
}
