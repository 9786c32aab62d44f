// SPDX-License-Identifier: Apache-2.0
// When the block has rested for so long that all meshes of the server's that were sent are displayed:
// then they replace the tiles of the page's copy.

import type { BlockCopy } from '../kernel/block_copy';
import type { StateMessage } from '../wire/types';
import type { LocalTiles } from '../view/local_tiles';

const SETTLE_MS = 1000;

export class Settling {
  private atRest_: StateMessage | null = null;
  private sinceMs_ = 0;
  /** The newest state that may not have the last undo or redo: it comes by another connection. */
  private before_: StateMessage | null = null;
  private hasChanged_ = false;

  constructor(
    private readonly copy: Pick<BlockCopy, 'settle'>,
    private readonly local: Pick<LocalTiles, 'settled'>,
  ) {}

  /** `isAsking`: the server has not answered an undo or redo yet. */
  step(state: StateMessage | null, isAsking: boolean, nowMs: number): void {
    if (isAsking) {
      this.before_ = state;
      this.hasChanged_ = true;
    }
    const isAtRest = state?.settled && state !== this.before_;
    if (!isAtRest || state !== this.atRest_) {
      this.atRest_ = isAtRest ? state : null;
      this.sinceMs_ = nowMs;
    } else if (nowMs - this.sinceMs_ > SETTLE_MS) {
      if (this.hasChanged_) this.copy.settle();
      this.hasChanged_ = false;
      this.local.settled(state.motions);
    }
  }
}
