// SPDX-License-Identifier: Apache-2.0
// Shows a value at every point of the displayed surface, as colors over the tiles. Sends the points
// of each tile to the source of the values, and draws the answers. A tile that changes keeps its
// colors until it has new ones.

import * as THREE from 'three';
import type { Valued } from '../../model/owners';
import { refined } from '../../model/refine';
import type { Triangles } from '../../model/refine';
import { squareOf } from '../../model/tiles';
import type { DisplayedTile } from '../tile_view';
import type { Viewer } from '../viewer';
import { VALUE_ATTRIBUTE } from './painted_material';

/** The values to show, and their source. */
export interface Painting {
  /** Shows VALUE_ATTRIBUTE. */
  material: THREE.Material;
  /** The triangles of a tile that are painted. */
  trianglesOf: (tile: DisplayedTile) => Triangles;
  questionsOf: (triangles: Triangles) => Float32Array<ArrayBuffer>;
  /** Of a question. */
  numbers: number;
  /** Of one request. */
  questionsMax: number;
  /** The answers to questions, in their order. */
  ask: (questions: Float32Array<ArrayBuffer>) => Promise<Answers>;
  /** Makes the mesh that is drawn. */
  paint: (triangles: Triangles, answers: Answers) => Valued;
  /** Asks for at most half of the time: answers cost much, and other pages ask too. */
  rests?: boolean;
}
export type Answers = Float32Array | Uint32Array;

/** Tiles along the side of a square, which is one draw call. */
const SQUARE = 8;

interface PaintedTile extends Valued {
  /** The tile under the paint. */
  tile: DisplayedTile;
}

/** The request for a tile. */
interface Question {
  tile: DisplayedTile;
  triangles: Triangles;
  numbers: Float32Array<ArrayBuffer>;
}

function isSame(a: DisplayedTile, b: DisplayedTile): boolean {
  return a.geometry === b.geometry && a.matrix.equals(b.matrix);
}

/**
 * The triangles of a tile in the block's coordinates, with edges of at most `limitMm`.
 * @param isWanted which triangles, by the vertices of the geometry
 */
export function trianglesOf(
  { geometry, matrix }: DisplayedTile,
  limitMm: number,
  isWanted: (a: number, b: number, c: number) => boolean = () => true,
): Triangles {
  const position = geometry.getAttribute('position');
  const normal = geometry.getAttribute('normal');
  const at = new THREE.Vector3();
  const turn = new THREE.Matrix3().getNormalMatrix(matrix);
  const positions = new Float32Array(3 * position.count);
  const normals = new Float32Array(3 * position.count);
  for (let n = 0; n < position.count; n += 1) {
    at.fromBufferAttribute(position, n)
      .applyMatrix4(matrix)
      .toArray(positions, 3 * n);
    at.fromBufferAttribute(normal, n)
      .applyMatrix3(turn)
      .normalize()
      .toArray(normals, 3 * n);
  }
  const all = geometry.index
    ? Uint32Array.from(geometry.index.array)
    : Uint32Array.from({ length: position.count }, (_, n) => n);
  const index = all.filter((_, n) => {
    const first = n - (n % 3);
    return isWanted(all[first]!, all[first + 1]!, all[first + 2]!);
  });
  return refined({ positions, normals, index }, limitMm);
}

export class PaintedView {
  /** Counts up whenever something else is painted. */
  revision = 0;
  private readonly group_ = new THREE.Group();
  private readonly painted_ = new Map<number, PaintedTile>();
  private readonly squares_ = new Map<number, THREE.Mesh>();
  private waiting_: DisplayedTile[] = [];
  private changes_ = -1;
  private isAsking_ = false;
  private isOpen_ = true;

  /** @param failed is called when answers do not come; nothing more is asked for then */
  constructor(
    private readonly viewer: Viewer,
    private readonly painting: Painting,
    private readonly failed: (problem: unknown) => void,
  ) {
    viewer.stage.scene.add(this.group_);
  }

  /** The share of the tiles whose colors are those of their values. */
  get share(): number {
    const all = this.painted_.size + this.waiting_.length;
    return all === 0 ? 1 : 1 - this.waiting_.length / all;
  }

  /** The painted tiles. */
  pieces(): Iterable<Valued> {
    return this.painted_.values();
  }

  /** Follows the displayed surface and the section; called some times a second. */
  update(): void {
    const { material } = this.painting;
    const { clippingPlanes } = this.viewer.stockMaterial.material;
    if (material.clippingPlanes !== clippingPlanes) {
      material.clippingPlanes = clippingPlanes;
      this.viewer.touch();
    }
    const { tiles } = this.viewer;
    if (tiles.changes !== this.changes_) {
      this.changes_ = tiles.changes;
      this.compare_(tiles.tiles());
    }
    if (!this.isAsking_ && this.waiting_.length > 0) void this.ask_();
  }

  dispose(): void {
    this.isOpen_ = false;
    this.viewer.stage.scene.remove(this.group_);
    for (const mesh of this.squares_.values()) mesh.geometry.dispose();
    this.painting.material.dispose();
    this.viewer.touch();
  }

  private compare_(tiles: readonly DisplayedTile[]): void {
    const shown = new Set(tiles.map(({ key }) => key));
    const gone = [...this.painted_.keys()].filter((key) => !shown.has(key));
    for (const key of gone) this.painted_.delete(key);
    this.draw_(gone);
    const eye = this.viewer.rig.controls.target;
    const place = new THREE.Vector3();
    const farness = (tile: DisplayedTile): number =>
      place.setFromMatrixPosition(tile.matrix).distanceToSquared(eye);
    this.waiting_ = tiles
      .filter((tile) => {
        const old = this.painted_.get(tile.key);
        return !old || !isSame(old.tile, tile);
      })
      .sort((a, b) => farness(a) - farness(b));
  }

  private async ask_(): Promise<void> {
    this.isAsking_ = true;
    const begin = performance.now();
    try {
      const batch = this.nextBatch_();
      const numbers = batch.reduce((sum, one) => sum + one.numbers.length, 0);
      const all = new Float32Array(numbers);
      let at = 0;
      for (const one of batch) {
        all.set(one.numbers, at);
        at += one.numbers.length;
      }
      this.take_(batch, numbers === 0 ? new Float32Array(0) : await this.painting.ask(all));
      if (this.painting.rests && numbers > 0) await pause(performance.now() - begin);
      this.isAsking_ = false;
    } catch (problem) {
      if (this.isOpen_) this.failed(problem); // and asks for nothing more
    }
  }

  /** As many tiles as a request may have, one at least. */
  private nextBatch_(): Question[] {
    const { painting } = this;
    const batch: Question[] = [];
    let left = painting.questionsMax * painting.numbers;
    for (const tile of this.waiting_) {
      const triangles = painting.trianglesOf(tile);
      const numbers = painting.questionsOf(triangles);
      if (batch.length > 0 && numbers.length > left) break;
      batch.push({ tile, triangles, numbers });
      left -= numbers.length;
    }
    return batch;
  }

  private take_(batch: readonly Question[], answers: Answers): void {
    if (!this.isOpen_) return;
    let at = 0;
    for (const { tile, triangles, numbers } of batch) {
      const end = at + numbers.length / this.painting.numbers;
      const painted = this.painting.paint(triangles, answers.subarray(at, end));
      this.painted_.set(tile.key, { ...painted, tile });
      at = end;
    }
    this.draw_(batch.map(({ tile }) => tile.key));
    this.compare_(this.viewer.tiles.tiles()); // it may have changed meanwhile
  }

  /** Makes the meshes again in which these tiles are. */
  private draw_(keys: readonly number[]): void {
    if (keys.length > 0) this.revision += 1;
    for (const square of new Set(keys.map((key) => squareOf(key, SQUARE)))) {
      const old = this.squares_.get(square);
      if (old) {
        this.group_.remove(old);
        old.geometry.dispose();
        this.squares_.delete(square);
      }
      const tiles = [...this.painted_]
        .filter(([key]) => squareOf(key, SQUARE) === square)
        .map(([, tile]) => tile)
        .filter(({ values }) => values.length > 0);
      if (tiles.length === 0) continue;
      const mesh = new THREE.Mesh(joined(tiles), this.painting.material);
      mesh.matrixAutoUpdate = false;
      this.squares_.set(square, mesh);
      this.group_.add(mesh);
    }
    this.viewer.touch();
  }
}

function pause(ms: number): Promise<void> {
  return new Promise((done) => setTimeout(done, ms));
}

function joined(tiles: readonly PaintedTile[]): THREE.BufferGeometry {
  const sum = (of: (tile: PaintedTile) => number): number =>
    tiles.reduce((total, tile) => total + of(tile), 0);
  const corners = sum(({ values }) => values.length);
  const positions = new Float32Array(3 * corners);
  const normals = new Float32Array(3 * corners);
  const values = new Float32Array(corners);
  const index = new Uint32Array(sum((tile) => tile.index.length));
  let first = 0;
  let at = 0;
  for (const tile of tiles) {
    positions.set(tile.positions, 3 * first);
    normals.set(tile.normals, 3 * first);
    values.set(tile.values, first);
    for (const corner of tile.index) index[at++] = corner + first;
    first += tile.values.length;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
  geometry.setAttribute(VALUE_ATTRIBUTE, new THREE.BufferAttribute(values, 1));
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  return geometry;
}
