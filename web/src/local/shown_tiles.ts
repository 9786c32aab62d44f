// SPDX-License-Identifier: Apache-2.0
// The tiles that the worker has sent: they wait for the view to open.

import type { TileTriangles } from '../kernel/kernel';
import { tileKey } from '../model/tiles';
import type { Picture } from '../ui/picture';

/** Of the block that is displayed: the page has no participants whose samples would be newer. */
const NEWEST = 1n;

export class ShownTiles {
  private readonly triangles_ = new Map<number, number>();
  private readonly waiting_ = new Map<number, TileTriangles>();

  constructor(private readonly picture: Picture) {}

  /** How many tiles are not displayed yet. */
  get waiting(): number {
    return this.waiting_.size;
  }

  /** Triangles of all tiles. */
  get triangles(): number {
    return [...this.triangles_.values()].reduce((sum, one) => sum + one, 0);
  }

  add(tiles: readonly TileTriangles[]): void {
    for (const tile of tiles) {
      const key = tileKey(tile.x, tile.y);
      this.waiting_.set(key, tile);
      this.triangles_.set(key, tile.index.length / 3);
    }
  }

  /** Displays the tiles that wait, once there is a view. */
  show(): void {
    const { viewer } = this.picture;
    if (!viewer || this.waiting_.size === 0) return;
    viewer.local.open();
    viewer.applyCopy([...this.waiting_.values()], NEWEST);
    this.waiting_.clear();
  }

  clear(): void {
    this.waiting_.clear();
    this.triangles_.clear();
    this.picture.viewer?.local.clear();
    this.picture.viewer?.touchAll();
  }
}
