// SPDX-License-Identifier: Apache-2.0
// The displayed tiles as pieces of a surface. Their corners are computed when something is first
// asked of them, and kept while the tile stays, until forget().

import * as THREE from 'three';
import type { Piece } from '../model/surface';
import type { DisplayedTile, TileView } from './tile_view';

function cornersOf({ geometry, matrix }: DisplayedTile): Float64Array {
  const { index, attributes } = geometry;
  const position = attributes['position']!;
  const count = index?.count ?? position.count;
  const vertices = new Float64Array(3 * position.count);
  const at = new THREE.Vector3();
  for (let n = 0; n < position.count; n += 1)
    at.fromBufferAttribute(position, n)
      .applyMatrix4(matrix)
      .toArray(vertices, 3 * n);
  const corners = new Float64Array(3 * count);
  for (let n = 0; n < count; n += 1) {
    const from = 3 * (index?.getX(n) ?? n);
    corners.set(vertices.subarray(from, from + 3), 3 * n);
  }
  return corners;
}

function pieceOf(tile: DisplayedTile): Piece {
  const { geometry, matrix } = tile;
  if (!geometry.boundingBox) geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox!.clone().applyMatrix4(matrix);
  let corners: Float64Array | null = null;
  return {
    min: min.toArray(),
    max: max.toArray(),
    corners: () => (corners ??= cornersOf(tile)),
  };
}

export class DisplayedSurface {
  private known_ = new Map<number, { tile: DisplayedTile; piece: Piece }>();
  private pieces_: Piece[] = [];
  private changes_ = -1;

  constructor(private readonly tiles: TileView) {}

  /** Counts up whenever the pieces change. */
  get changes(): number {
    return this.tiles.changes;
  }

  /** Lets the corners go, 72 bytes a triangle, until something is asked of the surface again. */
  forget(): void {
    this.known_.clear();
    this.pieces_ = [];
    this.changes_ = -1;
  }

  get pieces(): readonly Piece[] {
    if (this.changes_ === this.tiles.changes) return this.pieces_;
    this.changes_ = this.tiles.changes;
    const before = this.known_;
    this.known_ = new Map();
    for (const tile of this.tiles.tiles()) {
      const old = before.get(tile.key);
      const stays = old?.tile.geometry === tile.geometry && old.tile.matrix.equals(tile.matrix);
      this.known_.set(tile.key, stays ? old : { tile, piece: pieceOf(tile) });
    }
    this.pieces_ = [...this.known_.values()].map(({ piece }) => piece);
    return this.pieces_;
  }
}
