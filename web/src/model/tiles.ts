// SPDX-License-Identifier: Apache-2.0
// Which version of which tile is shown. A mesh frame carries whole tiles and may come twice, so the only rule is: what comes
// replaces what is there unless its version is older. An equal version is another level of detail. Every connection begins a new generation, because a server that was restarted may count its versions
// anew; what an old generation left behind is dropped when the new snapshot is complete, so nothing flickers in between.

export interface TileEntry {
  x: number;
  y: number;
  version: number;
  /** of detail; 0: exact */
  level: number;
  triangles: number;
  generation: number;
}

/** Tile coordinates in one number, so that a Map needs no strings. */
export function tileKey(x: number, y: number): number {
  return y * 65536 + x;
}

export class TileTable {
  private readonly entries_ = new Map<number, TileEntry>();
  private generation_ = 0;
  private complete_ = false;
  private triangles_ = 0;

  /** Starts to collect a new snapshot; tiles of the old one stay until they are replaced or the snapshot is complete. */
  beginSnapshot(): void {
    this.generation_ += 1;
    this.complete_ = false;
  }

  /** Offers a tile. Returns true if its mesh must be swapped in; false if it is older than what we have. */
  offer(x: number, y: number, version: number, triangles: number, level = 0): boolean {
    const key = tileKey(x, y);
    const entry = this.entries_.get(key);
    if (entry && entry.generation === this.generation_ && entry.version > version) return false;
    if (entry) {
      this.triangles_ += triangles - entry.triangles;
      entry.version = version;
      entry.level = level;
      entry.triangles = triangles;
      entry.generation = this.generation_;
    } else {
      this.triangles_ += triangles;
      this.entries_.set(key, { x, y, version, level, triangles, generation: this.generation_ });
    }
    return true;
  }

  /** Ends the snapshot. Returns the keys of tiles that it did not bring: they are gone from the server and from here. */
  finishSnapshot(): number[] {
    const stale: number[] = [];
    for (const [key, entry] of this.entries_) {
      if (entry.generation === this.generation_) continue;
      stale.push(key);
      this.triangles_ -= entry.triangles;
      this.entries_.delete(key);
    }
    this.complete_ = true;
    return stale;
  }

  /** True once the snapshot of this connection has been applied as a whole. */
  get complete(): boolean {
    return this.complete_;
  }

  /** Counts the snapshots begun. What was read for one must not be offered to the next: versions of two servers do not compare. */
  get generation(): number {
    return this.generation_;
  }

  get size(): number {
    return this.entries_.size;
  }

  get triangles(): number {
    return this.triangles_;
  }

  version(x: number, y: number): number | undefined {
    return this.entries_.get(tileKey(x, y))?.version;
  }

  /** All tiles in a fixed order, for tests and for comparing two viewers. */
  list(): TileEntry[] {
    return [...this.entries_.values()].sort((a, b) => a.y - b.y || a.x - b.x);
  }
}
