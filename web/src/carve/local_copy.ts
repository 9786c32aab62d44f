// SPDX-License-Identifier: Apache-2.0
// The page's copy of the block, its cuts in the picture.

import { t } from '../strings';
import { BlockCopy } from '../kernel/block_copy';
import type { WorkerPort } from '../kernel/block_copy';
import { moduleBeside } from '../kernel/module';
import type { Viewer } from '../view/viewer';

/** Whether kerf.wasm was there when the page was built, or was to come later (vite.config.ts). */
declare const KERF_HAS_KERNEL: boolean;

export const NO_COPY = t("This server can't preview cuts: they appear a moment later.");

/**
 * `felt`: the greatest cutting force of a frame's motions, N; `lacks`: the server must send its stock again; `ended`: the copy has, for
 * a reason.
 */
export function makeCopy(
  viewer: Viewer,
  felt: (forceN: number) => void,
  lacks: () => void,
  ended: (reason: string) => void,
): BlockCopy {
  const worker = new Worker(new URL('../kernel/worker.ts', import.meta.url), { type: 'module' });
  const module = KERF_HAS_KERNEL ? moduleBeside('kerf.wasm') : Promise.resolve(null);
  const copy = new BlockCopy(module, worker as WorkerPort, {
    tiles: (tiles, newest) => viewer.applyCopy(tiles, newest),
    changes: () => viewer.local.hold(),
    felt,
    lacks,
    failed: (reason) => {
      viewer.local.clear();
      ended(reason);
    },
  });
  viewer.local.hidden = (keys) => copy.hidden(keys);
  return copy;
}
