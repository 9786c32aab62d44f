// SPDX-License-Identifier: Apache-2.0
// Whether the tiles that are displayed lag behind the block.

import type { StateMessage } from '../wire/types';

/** How long the motions of a state may be missing in the tiles. */
const LATE_MS = 3000;

export class PictureLag {
  /** The server has sent mesh frames that have not come. */
  isMissing = false;
  private pictured_ = 0; // motions that the newest tiles include
  private awaited_: { motions: number; sinceMs: number } | null = null;

  /** A welcome: other tiles follow. */
  reset(): void {
    this.isMissing = false;
    this.pictured_ = 0;
    this.awaited_ = null;
  }

  /** Tiles with so many motions are displayed. */
  pictured(motions: number): void {
    this.pictured_ = Math.max(this.pictured_, motions);
    if (this.awaited_ && this.pictured_ >= this.awaited_.motions) this.awaited_ = null;
  }

  /** The server says how far the block is, and whether it has sent all tiles of that. */
  heard({ motions, settled, at }: StateMessage, nowMs: number): void {
    if (settled || at) this.awaited_ = null;
    else if (motions > this.pictured_) this.awaited_ ??= { motions, sinceMs: nowMs };
  }

  isBehind(nowMs: number): boolean {
    return this.isMissing || (this.awaited_ !== null && nowMs - this.awaited_.sinceMs > LATE_MS);
  }
}
