// SPDX-License-Identifier: Apache-2.0
// The badge beside the state hash, where the page can replay a journal.

import { checkBadge } from './badge';

/** Whether kerf_files.wasm was there when the page was built (vite.config.ts). */
declare const KERF_HAS_FILES: boolean;

/** Null where the page cannot replay. */
export function mountCheck(session: string): HTMLElement | null {
  if (!KERF_HAS_FILES) return null;
  return checkBadge(async (tell) => {
    const { checkSession } = await import('./check');
    await checkSession(session, tell);
  });
}
