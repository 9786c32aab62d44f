// SPDX-License-Identifier: Apache-2.0
// The displayed version of each tile. Mesh frames carry whole tiles and may arrive twice, so a tile
// replaces the displayed one unless its version is older; an equal version is another level of
// detail. Every connection starts a new generation, because a restarted server may count versions
// from 1 again. Tiles of older generations are removed when the new snapshot is complete, which
// avoids flicker.

import { signal } from '@preact/signals';

export interface TileEntry {
  x: number;
  y: number;
  version: number;
  /** Level of detail; 0 is exact. */
  level: number;
  triangles: number;
  generation: number;
  /** Of its columns, as the server states it; missing: it does not. */
  digest: string | undefined;
}

/** Packs tile coordinates into one number, as a Map key. */
export function tileKey(x: number, y: number): number {
  return y * 65536 + x;
}

/** The coordinates in a key. */
export function tileAt(key: number): [x: number, y: number] {
  return [key % 65536, Math.floor(key / 65536)];
}

/** Packs the square of `side` x `side` tiles in which a tile is into one number, as a Map key. */
export function squareOf(key: number, side: number): number {
  const [x, y] = tileAt(key);
  return tileKey(Math.floor(x / side), Math.floor(y / side));
}

/** A tile with no more triangles is flat, at any level. */
const FLAT_TRIANGLES = 12;
/** A carved tile has about so many when it is exact: two for each of its 32 × 32 cells, and walls. */
const EXACT_TRIANGLES = 2600;

export class TileTable {
  private readonly entries_ = new Map<number, TileEntry>();
  private generation_ = 0;
  private complete_ = false;
  private triangles_ = 0;
  private coarse_ = 0; // tiles with a level above 0
  private readonly exact_ = signal(false);

  /**
   * Starts a new snapshot. Tiles of the previous one stay until they are replaced or the new
   * snapshot is complete.
   */
  beginSnapshot(): void {
    this.generation_ += 1;
    this.complete_ = false;
    this.updateExact_();
  }

  /**
   * Offers a tile. Returns true if its mesh must be displayed; false if a newer version is
   * displayed already.
   */
  offer(
    x: number,
    y: number,
    version: number,
    triangles: number,
    level = 0,
    digest?: string,
  ): boolean {
    const key = tileKey(x, y);
    const entry = this.entries_.get(key);
    if (entry?.generation === this.generation_ && entry.version > version) return false;
    this.coarse_ += Number(level > 0) - Number((entry?.level ?? 0) > 0);
    if (entry) {
      this.triangles_ += triangles - entry.triangles;
      entry.version = version;
      entry.level = level;
      entry.triangles = triangles;
      entry.generation = this.generation_;
      entry.digest = digest;
    } else {
      this.triangles_ += triangles;
      const generation = this.generation_;
      this.entries_.set(key, { x, y, version, level, triangles, generation, digest });
    }
    this.updateExact_();
    return true;
  }

  /** Ends the snapshot. Removes the tiles that it did not contain and returns their keys. */
  finishSnapshot(): number[] {
    const stale: number[] = [];
    for (const [key, entry] of this.entries_) {
      if (entry.generation === this.generation_) continue;
      stale.push(key);
      this.triangles_ -= entry.triangles;
      this.coarse_ -= Number(entry.level > 0);
      this.entries_.delete(key);
    }
    this.complete_ = true;
    this.updateExact_();
    return stale;
  }

  /** True once the snapshot of this connection has been applied completely. */
  get complete(): boolean {
    return this.complete_;
  }

  /**
   * Counts the snapshots. Tiles parsed for one must not be offered to the next: versions of two
   * servers are not comparable.
   */
  get generation(): number {
    return this.generation_;
  }

  get size(): number {
    return this.entries_.size;
  }

  get triangles(): number {
    return this.triangles_;
  }

  /** Whether no tile is displayed coarser than the block is. */
  get exact(): boolean {
    return this.exact_.value;
  }

  /** About how many triangles there are when all tiles are exact. */
  get exactTriangles(): number {
    let sum = 0;
    for (const { level, triangles } of this.entries_.values()) {
      const isCoarse = level > 0 && triangles > FLAT_TRIANGLES;
      sum += isCoarse ? Math.max(triangles, EXACT_TRIANGLES) : triangles;
    }
    return sum;
  }

  version(x: number, y: number): number | undefined {
    return this.entries_.get(tileKey(x, y))?.version;
  }

  /** Returns all tiles ordered by y, then x, for tests and for comparing two viewers. */
  list(): TileEntry[] {
    return [...this.entries_.values()].sort((a, b) => a.y - b.y || a.x - b.x);
  }

  private updateExact_(): void {
    this.exact_.value = this.complete_ && this.coarse_ === 0;
  }
}
