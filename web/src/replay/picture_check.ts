// SPDX-License-Identifier: Apache-2.0
// Compares the tiles that are displayed with those of the page's own replay: the digest of each
// tile's columns, which the server states along with the mesh, and the mesh itself with one that
// the replay makes.

import type { TileTriangles } from '../kernel/kernel';
import { tileKey } from '../model/tiles';
import type { Replayer } from './replayer';
import type { ShownPicture, ShownTile } from './shown_picture';
import { isSameSurface } from './tile_distance';
import type { Corners } from './tile_distance';

/** How far a mesh may be off, pitches, by its level of detail (server/feed/README.md). */
const OFF_PITCHES = [1, 1, 2, 4];
/** So many meshes are compared at most, spread over all tiles; digests are compared of all. */
const MESHES_MAX = 400;
const NONE: Corners = new Float64Array(0);

function cornersOf({ positions, index }: TileTriangles): Corners {
  const corners = new Float64Array(3 * index.length);
  index.forEach((vertex, n) => corners.set(positions.subarray(3 * vertex, 3 * vertex + 3), 3 * n));
  return corners;
}

/** The digests of a block that is replayed. */
export class PictureCheck {
  private readonly digests_ = new Map<number, string>();

  /** @param random which meshes are compared of a large block */
  constructor(
    private readonly replayer: Replayer,
    private readonly random: () => number = Math.random,
  ) {}

  /** Counts the tiles that do not show the state of the replay. */
  async differing(shown: ShownPicture): Promise<number> {
    for (const { x, y, digest } of await this.replayer.digests())
      this.digests_.set(tileKey(x, y), digest);
    const tiles = shown.tiles();
    const isDrawn = new Set(tiles.map(({ x, y }) => tileKey(x, y)));
    const missing = [...this.digests_.keys()].filter((key) => !isDrawn.has(key)).length;
    const other = tiles.filter(({ x, y, digest }) => digest !== this.digests_.get(tileKey(x, y)));
    if (missing + other.length > 0) return missing + other.length;
    return this.differingMeshes_(shown, tiles);
  }

  private async differingMeshes_(shown: ShownPicture, tiles: ShownTile[]): Promise<number> {
    const corners = shown.corners();
    const share = MESHES_MAX / tiles.length;
    let differing = 0;
    for (const { x, y, level } of tiles) {
      if (this.random() >= share) continue;
      const own = cornersOf(await this.replayer.mesh(x, y));
      const off = (OFF_PITCHES[level] ?? OFF_PITCHES.at(-1)!) * shown.pitchMm;
      if (!isSameSurface(corners.get(tileKey(x, y)) ?? NONE, own, off)) differing += 1;
    }
    return differing;
  }
}
