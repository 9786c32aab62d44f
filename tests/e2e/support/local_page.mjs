// SPDX-License-Identifier: Apache-2.0
// What tests of kerf.html need: its state at rest, strokes by hand, and the .kerf file that it writes,
// which kerf-server replays.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFile } from 'node:fs/promises';
import { placeOf } from './block.mjs';
import { until } from './processes.mjs';

const SETTLE_S = 60; // software WebGL on a busy machine

/** Waits for the state after what was done; `isDone`: of a state. */
export function settled(viewer, what, isDone) {
  return until(what, SETTLE_S, async () => {
    // All of one state: on a busy machine a stroke pauses, and the block of a pause has a hash too.
    const state = await viewer.state();
    const isAtRest = state.status === 'rest' && state.hash !== null && !state.isBusy;
    return isAtRest && state.waiting === 0 && isDone(state) && state;
  });
}

/** Waits for the hand, which a key or a button has taken up. */
export const isJoined = ({ page }) => page.locator('main[data-carve=ready]').waitFor();

async function stroke(viewer, y) {
  const { mouse } = viewer.page;
  await mouse.move(...(await placeOf(viewer, 0.35, y)));
  await mouse.down();
  for (const x of [0.4, 0.5, 0.6])
    await mouse.move(...(await placeOf(viewer, x, y + 0.02)), { steps: 6 });
  await mouse.up();
}

/** Carves a stroke at a share of the block's height in the picture; returns the state after it. */
export async function carvedMore(viewer, before, y) {
  await stroke(viewer, y);
  return settled(viewer, 'stroke', ({ hash }) => hash !== before.hash);
}

/** Saves the page's .kerf file. */
export async function savedTo({ page }, file) {
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: 'KERF', exact: true }).click(),
  ]);
  assert.match(download.suggestedFilename(), /^[a-z0-9_-]+\.kerf$/);
  await copyFile(await download.path(), file);
}

/** kerf-server carves the file from its first record: to the state that the page has. */
export function checkReplayed(program, file, { hash }) {
  const { status, stdout, stderr } = spawnSync(program, ['replay', file], { encoding: 'utf8' });
  assert.equal(status, 0, stdout + stderr);
  assert.match(stdout, /^equal: .* 1 state hashes/);
  assert(stdout.includes(`hash ${hash}`), `${stdout} is not ${hash}`);
}
