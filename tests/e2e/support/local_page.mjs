// SPDX-License-Identifier: Apache-2.0
// Helpers for tests of kerf.html: wait until it is at rest, carve strokes, save its .kerf file, and
// replay that file with kerf-server.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFile } from 'node:fs/promises';
import { placeOf } from './block.mjs';
import { until } from './processes.mjs';

const SETTLE_S = 60; // software WebGL on a busy machine

/** Waits until the page is at rest in a state for which `isDone` is true; returns that state. */
export function settled(viewer, what, isDone) {
  return until(what, SETTLE_S, async () => {
    // All of one state: on a busy machine a stroke pauses, and the block of a pause has a hash too.
    const state = await viewer.state();
    const isAtRest = state.status === 'rest' && state.hash !== null && !state.isBusy;
    return isAtRest && state.waiting === 0 && isDone(state) && state;
  });
}

/** Waits until the page is ready to carve. */
export const isJoined = ({ page }) => page.locator('main[data-carve=ready]').waitFor();

async function stroke(viewer, y) {
  const { mouse } = viewer.page;
  await mouse.move(...(await placeOf(viewer, 0.35, y)));
  await mouse.down();
  for (const x of [0.4, 0.5, 0.6])
    await mouse.move(...(await placeOf(viewer, x, y + 0.02)), { steps: 6 });
  await mouse.up();
}

/** Carves a stroke at `y`, a fraction of the block's height in the picture; returns the new state. */
export async function carvedMore(viewer, before, y) {
  await stroke(viewer, y);
  return settled(viewer, 'stroke', ({ hash }) => hash !== before.hash);
}

/** The file that a button of the dialog of downloads gives. */
export async function downloadOf(page, format) {
  await page.getByRole('button', { name: 'Download', exact: true }).click();
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: format, exact: true }).click(),
  ]);
  await page.getByRole('button', { name: 'Close', exact: true }).click();
  return download;
}

/** Saves the page's .kerf file. */
export async function savedTo({ page }, file) {
  const download = await downloadOf(page, 'KERF');
  assert.match(download.suggestedFilename(), /^[a-z0-9_-]+\.kerf$/);
  await copyFile(await download.path(), file);
}

/** Checks that kerf-server replays the file to the page's state hash. */
export function checkReplayed(program, file, { hash }) {
  const { status, stdout, stderr } = spawnSync(program, ['replay', file], { encoding: 'utf8' });
  assert.equal(status, 0, stdout + stderr);
  assert.match(stdout, /^equal: .* 1 state hashes/);
  assert(stdout.includes(`hash ${hash}`), `${stdout} is not ${hash}`);
}
