// SPDX-License-Identifier: Apache-2.0
// Facts of the block for tests of carving in a page: where it is in the window, and the server's block
// once the page has the same.

import assert from 'node:assert/strict';
import { until } from './processes.mjs';

/** Where a place of the block's box is in the window; `x` and `y` are shares of the box. */
export async function placeOf({ state }, x, y) {
  const [left, top, right, bottom] = (await state()).blockBox;
  return [left + x * (right - left), top + y * (bottom - top)];
}

/**
 * Waits until the server's session, as `isDone` says of it, the page's copy and what the page displays
 * are one block; returns the session. It is asked for at every try, because a busy server shows blocks
 * in the middle of a stroke, to which a page never returns.
 */
export async function restingBlock({ page, state }, readSession, what, seconds, isDone) {
  return until(what, seconds, async () => {
    const session = await readSession();
    assert(isDone(session), 'the server has another block');
    const { hash: shown, copyTiles } = await state();
    const copy = await page.evaluate(() => window.kerf.copyHash());
    const { state_hash: hash } = session;
    assert.deepEqual({ shown, copy, copyTiles }, { shown: hash, copy: hash, copyTiles: 0 });
    return session;
  });
}
