// SPDX-License-Identifier: Apache-2.0
// Whether the mesh frames of a server come, each once, whole and in order. The server numbers them,
// and says in each pong which one it has sent last (`verify`, server/wire/README.md): on one
// connection nothing overtakes them, so one that is missing then was lost or held up between.

import { MESH_SUMMED } from '../wire/checksum';
import type { Header } from '../wire/types';

/** Pongs in a row that find frames missing, until they count as lost. */
const LATE_PONGS_MAX = 5;

export class FrameWatch {
  private last_: bigint | null = null; // null: the server does not say
  private latePongs_ = 0;

  /** A welcome. `meshes`: the frame before the first one; missing: the server says nothing. */
  begin(meshes: number | undefined): void {
    this.last_ = meshes === undefined ? null : BigInt(meshes);
    this.latePongs_ = 0;
  }

  /** Whether the server says which frames it sends. */
  get watches(): boolean {
    return this.last_ !== null;
  }

  /** A mesh frame came. Returns whether it is the next one, with a checksum. */
  isNext({ sequence, flags }: Header): boolean {
    if (this.last_ === null) return true;
    const isNext = sequence === this.last_ + 1n && (flags & MESH_SUMMED) !== 0;
    this.last_ = sequence;
    return isNext;
  }

  /** A pong came, before which the server had sent the frames up to `sequence`. */
  sent(sequence: bigint): void {
    if (this.last_ === null) return;
    this.latePongs_ = sequence > this.last_ ? this.latePongs_ + 1 : 0;
  }

  /** Whether frames have not come that must have. */
  get isLate(): boolean {
    return this.latePongs_ > 0;
  }

  /** Whether they will not come any more. */
  get isLost(): boolean {
    return this.latePongs_ >= LATE_PONGS_MAX;
  }
}
