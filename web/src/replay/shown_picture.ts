// SPDX-License-Identifier: Apache-2.0
// The displayed tiles, as the check compares them with its own replay.

import type { SessionModel } from '../model/session';
import type { Viewer } from '../view/viewer';
import type { Corners } from './tile_distance';

/** A tile that is displayed. */
export interface ShownTile {
  x: number;
  y: number;
  level: number;
  /** Of its columns, as the server states it. */
  digest: string | undefined;
}

export interface ShownPicture {
  /** The block's state that the tiles are to show; null: tiles are to come, or of the past. */
  readonly hash: string | null;
  /** Whether the tiles are late, so that it is unknown when they show a state. */
  readonly isBehind: boolean;
  readonly pitchMm: number;
  tiles(): ShownTile[];
  /** Of the triangles of each tile, by tileKey; in mm from the block's corner. */
  corners(): Map<number, Corners>;
}

/** Where a tile of the page's own copy is displayed, the check compares that one. */
function cornersOf(viewer: Viewer, originMm: readonly number[]): Map<number, Corners> {
  const corners = new Map<number, Corners>();
  for (const { key, geometry, matrix } of viewer.tiles.tiles()) {
    const { index, attributes } = geometry;
    const position = attributes['position']!;
    const count = index?.count ?? position.count;
    const { elements: m } = matrix;
    const of = new Float64Array(3 * count);
    for (let n = 0; n < count; ++n) {
      const at = index?.getX(n) ?? n;
      const [x, y, z] = [position.getX(at), position.getY(at), position.getZ(at)];
      for (let axis = 0; axis < 3; ++axis)
        of[3 * n + axis] =
          m[axis]! * x + m[4 + axis]! * y + m[8 + axis]! * z + m[12 + axis]! - originMm[axis]!;
    }
    corners.set(key, of);
  }
  return corners;
}

/** The picture of a page; null while there is none, as without WebGL. */
export function shownPicture(model: SessionModel, viewer: Viewer | null): ShownPicture | null {
  const { welcome } = model;
  if (!viewer || !welcome) return null;
  return {
    get hash() {
      const { state, tiles, status } = model;
      const isThere = status === 'connected' && tiles.complete && state?.settled && !state.at;
      return isThere && !this.isBehind ? state.state_hash : null;
    },
    get isBehind() {
      return model.lag.isBehind(performance.now());
    },
    pitchMm: welcome.pitch_mm,
    tiles: () => model.tiles.list(),
    corners: () => cornersOf(viewer, welcome.grid.origin_mm),
  };
}
