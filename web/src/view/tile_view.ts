// SPDX-License-Identifier: Apache-2.0
// The block's surface. The tiles of a square of the block are one mesh, thus one draw call, and
// another where shadows are drawn. Tiles are replaced as a whole.

import * as THREE from 'three';
import { squareOf, tileAt, tileKey } from '../model/tiles';
import { ORIGINAL_ATTRIBUTE } from './parsed_tiles';
import type { ParsedTile } from './parsed_tiles';
import { TileSquare } from './tile_square';
import type { PlacedShape } from './tile_square';

/** Tiles along a side of a square. */
const SQUARE = 16;

/** A displayed tile. */
export interface DisplayedTile extends PlacedShape {
  key: number;
}

export class TileView {
  readonly group = new THREE.Group();
  /** Counts up whenever the surface changes. */
  changes = 0;
  private readonly squares_ = new Map<number, TileSquare>();

  constructor(private readonly material: THREE.Material) {
    this.group.matrixAutoUpdate = false;
  }

  /** Returns a tile that is not displayed, by which shaders can be compiled. */
  sample(): THREE.Mesh {
    return new TileSquare(this.material, SQUARE).mesh;
  }

  /** Displays the tile at x, y of those that `tile` stands for, whose sides have `sideMm`. */
  set(tile: ParsedTile, x: number, y: number, sideMm: number): void {
    const key = tileKey(x, y);
    this.changes += 1;
    if (!tile.geometry) {
      this.remove(key);
      return;
    }
    const matrix = new THREE.Matrix4()
      .makeTranslation((x - tile.x) * sideMm, (y - tile.y) * sideMm, 0)
      .multiply(tile.matrix);
    this.square_(key).set(key, { geometry: tile.geometry, matrix });
  }

  remove(key: number): void {
    const square = this.squares_.get(squareOf(key, SQUARE));
    if (!square?.get(key)) return;
    this.changes += 1;
    square.remove(key);
    if (square.size > 0) return;
    this.squares_.delete(squareOf(key, SQUARE));
    square.dispose();
  }

  /** The tile that is displayed at a key, as it would be set again; null: none. */
  get(key: number): ParsedTile | null {
    const shown = this.squares_.get(squareOf(key, SQUARE))?.get(key);
    if (!shown) return null;
    const [x, y] = tileAt(key);
    const one = { columns: 1, rows: 1, version: 0, level: 0, motions: 0, triangles: 0 };
    return { x, y, ...one, ...shown };
  }

  tiles(): DisplayedTile[] {
    return [...this.squares_.values()].flatMap((square) => square.tiles());
  }

  /** Has rectangles of slabs drawn with fewer triangles, until one of them changes. */
  mergeSlabs(): void {
    for (const square of this.squares_.values()) square.mergeSlabs();
  }

  /** The meshes of the tiles as they are displayed now, which stay. */
  copies(): THREE.Mesh[] {
    return [...this.squares_.values()].map((square) => square.copy());
  }

  /** Returns a test of a tile's vertices: whether one is on the surface of the untouched stock. */
  originalOf({ geometry }: DisplayedTile): (vertex: number) => boolean {
    const original = geometry.attributes[ORIGINAL_ATTRIBUTE];
    return (vertex) => original !== undefined && original.getX(vertex) > 0.5;
  }

  /** Returns the first intersection of a ray with the block, or null. */
  pick(raycaster: THREE.Raycaster): THREE.Vector3 | null {
    return raycaster.intersectObjects(this.group.children, false)[0]?.point ?? null;
  }

  /** The corners of all triangles, nine numbers each, mm. */
  corners(): number[] {
    const corners: number[] = [];
    const at = new THREE.Vector3();
    for (const { geometry, matrix } of this.tiles()) {
      const { index, attributes } = geometry;
      const position = attributes['position']!;
      const count = index?.count ?? position.count;
      for (let n = 0; n < count; ++n) {
        at.fromBufferAttribute(position, index?.getX(n) ?? n).applyMatrix4(matrix);
        corners.push(at.x, at.y, at.z);
      }
    }
    return corners;
  }

  private square_(key: number): TileSquare {
    let square = this.squares_.get(squareOf(key, SQUARE));
    if (!square) {
      square = new TileSquare(this.material, SQUARE);
      this.squares_.set(squareOf(key, SQUARE), square);
      this.group.add(square.mesh);
    }
    return square;
  }
}
