// SPDX-License-Identifier: Apache-2.0
// The surface that the page displays, as it was at one moment, for rays from the pointer. A ray is
// tested against the boxes of its pieces first, and against the triangles of those that it meets,
// from the nearest on.

import { Line } from '../model/line';
import { normalOf } from '../model/surface';
import type { Hit, Piece } from '../model/surface';
import { dot, plus, scaled, unitOf } from '../model/vector';
import type { Vec3 } from '../wire/types';

export interface Ray {
  origin: Vec3;
  /** Unit length. */
  direction: Vec3;
}

export class Surface {
  private readonly mins_: Float64Array;
  private readonly maxs_: Float64Array;

  constructor(private readonly pieces_: readonly Piece[]) {
    this.mins_ = new Float64Array(3 * pieces_.length);
    this.maxs_ = new Float64Array(3 * pieces_.length);
    pieces_.forEach(({ min, max }, n) => {
      this.mins_.set(min, 3 * n);
      this.maxs_.set(max, 3 * n);
    });
  }

  /** The first place where a ray enters the block, within `reach` mm; null if it does not. */
  hit({ origin, direction }: Ray, reach = Infinity): Hit | null {
    const line = new Line(origin, direction);
    const met: [at: number, piece: number][] = [];
    for (let n = 0; n < this.pieces_.length; ++n) {
      const at = line.enters(this.mins_, this.maxs_, 3 * n, 0);
      if (at < reach) met.push([at, n]);
    }
    met.sort(([a], [b]) => a - b);
    let best: Hit | null = null;
    let nearest = reach;
    for (const [at, n] of met) {
      if (at > nearest) break;
      const found = firstOf(this.pieces_[n]!, line, nearest);
      if (!found) continue;
      best = found;
      nearest = found.at;
    }
    return best;
  }

  /**
   * The normal at a hit, averaged over places around it: fine ridges do not turn a tool. `around`
   * has their directions, in the surface's plane; each is probed from `radius` above.
   */
  smoothNormal({ point, normal }: Hit, around: readonly Vec3[], radius: number): Vec3 {
    const near = this.near(point, 3 * radius);
    const direction = scaled(normal, -1);
    let sum = normal;
    for (const offset of around) {
      const origin = plus(plus(point, offset, radius), normal, radius);
      const probe = near.hit({ origin, direction }, 2 * radius);
      if (probe) sum = plus(sum, probe.normal);
    }
    return unitOf(sum);
  }

  /** The pieces around a point, whose rays are faster. */
  near(point: Vec3, radius: number): Surface {
    return new Surface(
      this.pieces_.filter((_, n) => {
        for (let i = 0; i < 3; ++i) {
          const at = point[i]!;
          if (at + radius < this.mins_[3 * n + i]! || at - radius > this.maxs_[3 * n + i]!)
            return false;
        }
        return true;
      }),
    );
  }
}

/** The nearest place closer than `reach` where a ray enters a piece from its front; or null. */
function firstOf(piece: Piece, line: Line, reach: number): Hit | null {
  const { origin, direction } = line;
  const corners = piece.corners();
  let best: Hit | null = null;
  let nearest = reach;
  for (let n = 0; n < corners.length; n += 9) {
    const at = line.meets(corners, n);
    if (!(at >= 0 && at < nearest)) continue;
    const normal = normalOf(corners, n);
    if (dot(normal, direction) >= 0) continue;
    nearest = at;
    best = { at, point: plus(origin, direction, at), normal, enters: true };
  }
  return best;
}
