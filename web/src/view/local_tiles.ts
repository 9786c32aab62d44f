// SPDX-License-Identifier: Apache-2.0
// Tiles of the page's own copy of the block over those of the server: each is displayed until a mesh
// of the server has all of the page's motions that are in it.

import * as THREE from 'three';
import type { TileTriangles } from '../kernel/kernel';
import { tileKey } from '../model/tiles';
import type { Vec3 } from '../wire/types';
import { ORIGINAL_ATTRIBUTE } from './parsed_tiles';
import type { ParsedTile } from './parsed_tiles';
import type { TileView } from './tile_view';

const RESULTS_MAX = 1024;

/** A tile of the copy, and the server's tile that it replaces. */
interface Covered {
  /** The newest of the page's samples that is in it. */
  newest: bigint;
  /** The server's; null: it displays nothing there. */
  behind: ParsedTile | null;
}

export class LocalTiles {
  /** Tiles whose server's mesh is displayed again. */
  hidden: (keys: number[]) => void = () => undefined;
  private readonly covered_ = new Map<number, Covered>();
  /** With how many motions of the block the server had answered a sample, in order. */
  private results_: { sequence: bigint; motions: number }[] = [];
  private isOpen_ = false;
  private isHeld_ = false;
  /** The newest sample that was answered when the server's tiles only were displayed last. */
  private cleared_ = 0n;

  constructor(private readonly tiles: TileView) {}

  /** How many tiles are the copy's. */
  get size(): number {
    return this.covered_.size;
  }

  /** The page carves: tiles of its copy are displayed. */
  open(): void {
    this.isOpen_ = true;
  }

  /** Displays the server's tiles only, also instead of those that the copy makes later. */
  close(): void {
    this.clear();
    this.isOpen_ = false;
  }

  /**
   * The copy has an undo or redo before the server: no mesh of the server replaces a tile of the
   * copy, whatever motions it has, until settled().
   */
  hold(): void {
    this.isHeld_ = this.isOpen_;
  }

  /**
   * Displays tiles of the copy, which has the page's samples up to `newest`; not those that would
   * wait for an answer that has come, or does not come.
   */
  cover(tiles: readonly TileTriangles[], newest: bigint, originMm: Vec3): void {
    if (!this.isOpen_ || (newest <= this.cleared_ && !this.isHeld_)) {
      this.hidden(tiles.map(({ x, y }) => tileKey(x, y)));
      return;
    }
    for (const tile of tiles) {
      const key = tileKey(tile.x, tile.y);
      const before = this.covered_.get(key);
      const behind = before ? before.behind : this.tiles.get(key);
      this.covered_.set(key, { newest, behind });
      this.tiles.set(this.parsed_(tile, originMm), tile.x, tile.y, 0);
    }
  }

  /** The server's tile at x, y of those that `tile` stands for. */
  set(tile: ParsedTile, x: number, y: number, sideMm: number): void {
    const covered = this.covered_.get(tileKey(x, y));
    if (!covered) {
      this.tiles.set(tile, x, y, sideMm);
      return;
    }
    const matrix = new THREE.Matrix4()
      .makeTranslation((x - tile.x) * sideMm, (y - tile.y) * sideMm, 0)
      .multiply(tile.matrix);
    covered.behind = { ...tile, x, y, columns: 1, rows: 1, matrix };
    this.release_();
  }

  /** The server has no such tile. */
  remove(key: number): void {
    const covered = this.covered_.get(key);
    if (covered) covered.behind = null;
    else this.tiles.remove(key);
  }

  /** The server's answer to the page's samples up to one: the block then had so many motions. */
  answered(sequence: bigint, motions: number): void {
    if (this.covered_.size === 0) this.results_ = [];
    this.results_.push({ sequence, motions });
    if (this.results_.length > RESULTS_MAX) this.results_.shift();
    this.release_();
  }

  /** Displays the server's tiles only. */
  clear(): void {
    this.uncover_([...this.covered_.keys()]);
    this.cleared_ = this.results_.at(-1)?.sequence ?? this.cleared_;
    this.results_ = [];
    this.isHeld_ = false;
  }

  /** All meshes of the block with so many motions are displayed: some tiles were not sent again. */
  settled(motions: number): void {
    this.isHeld_ = false;
    this.release_(motions);
  }

  private release_(atLeast = 0): void {
    if (this.isHeld_) return;
    const isThere = ({ newest, behind }: Covered): boolean => {
      const answer = this.results_.find(({ sequence }) => sequence >= newest);
      return answer !== undefined && Math.max(behind?.motions ?? 0, atLeast) >= answer.motions;
    };
    this.uncover_([...this.covered_].filter(([, one]) => isThere(one)).map(([key]) => key));
  }

  private uncover_(keys: number[]): void {
    for (const key of keys) {
      const { behind } = this.covered_.get(key)!;
      this.covered_.delete(key);
      if (behind) this.tiles.set(behind, behind.x, behind.y, 0);
      else this.tiles.remove(key);
    }
    if (keys.length > 0) this.hidden(keys);
  }

  private parsed_(tile: TileTriangles, originMm: Vec3): ParsedTile {
    const { x, y, positions, normals, index, original } = tile;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
    geometry.setAttribute(ORIGINAL_ATTRIBUTE, new THREE.BufferAttribute(original, 1));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    return {
      x,
      y,
      columns: 1,
      rows: 1,
      version: 0,
      level: 0,
      motions: 0,
      triangles: index.length / 3,
      geometry: index.length > 0 ? geometry : null,
      matrix: new THREE.Matrix4().makeTranslation(...originMm),
    };
  }
}
