// SPDX-License-Identifier: Apache-2.0
// End-to-end test of carving in a page that comes from a server which follows the session: its hand
// goes on at the owner, and both have the cut. Then the owner hands the session over. See README.md.
//
// node follower_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { placeOf, restingBlock } from './support/block.mjs';
import { openViewer, withBrowser } from './support/browser.mjs';
import { findNats, startNats, startNode } from './support/cluster.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { getJson, optionsOf, runTest } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 90; // software WebGL on a busy machine
const SCENE = boxScene('Shared', [-20, -15, -10], [20, 15, 0], [cutter(1, 'ball', 6)]);

const sessionOf = (base) => getJson(`${base}/v1/sessions/shared`);

/** Drags the mouse across the block; `y` is a share of the block's box. */
async function drag(viewer, y) {
  const { mouse } = viewer.page;
  await mouse.move(...(await placeOf(viewer, 0.35, y)));
  await mouse.down();
  for (const x of [0.45, 0.55, 0.65]) await mouse.move(...(await placeOf(viewer, x, y)));
  await mouse.up();
}

/** Waits until both servers have the same block, as `isDone` says; returns the session. */
async function equalBlocks(what, [owner, follower], isDone) {
  return until(what, SETTLE_S, async () => {
    const [one, other] = [await sessionOf(owner.base), await sessionOf(follower.base)];
    const isEqual = one.motions === other.motions && one.state_hash === other.state_hash;
    return isEqual && isDone(one) && one;
  });
}

/** Waits until a server, as `isDone` says, and the page have the same block; returns the session. */
function equalPage(viewer, { base }, what, isDone) {
  return restingBlock(viewer, () => sessionOf(base), what, SETTLE_S, isDone);
}

async function stopped({ server }) {
  assert.equal(await stop(server), 0, `a server exited with an error: ${server.errors}`);
}

/** The owner stops and names the follower: the hand goes on there, as the same participant. */
async function checkHandover(viewer, owner, follower, { motions }) {
  const { page, state } = viewer;
  await stopped(owner);
  await until('the follower owns the session', SETTLE_S, async () => {
    const response = await fetch(`${follower.base}/v1/sessions/shared`);
    return response.ok && !(await response.json()).followed;
  });
  // The page's hand may still be that of the owner that has stopped.
  await until('the hand at the follower', SETTLE_S, async () => {
    const { participants } = await sessionOf(follower.base);
    return participants.some(({ kind }) => kind === 'agent');
  });
  await page.locator('main[data-carve=ready]').waitFor();
  await until('the page watches', SETTLE_S, async () => (await state()).status === 'connected');
  await drag(viewer, 0.6);
  await equalPage(viewer, follower, 'cut after the handover', (now) => now.motions > motions);
  const { authors } = await getJson(`${follower.base}/v1/sessions/shared/authors`);
  assert.deepEqual(
    authors.map(({ name }) => name),
    ['Vi'],
  );
}

async function startPair(folder) {
  const nats = await startNats(findNats(), folder);
  const owner = await startNode(options, folder, nats, 'owner');
  const body = JSON.stringify(SCENE);
  const created = await fetch(`${owner.base}/v1/sessions?id=shared`, {
    method: 'POST',
    body,
  });
  assert.equal(created.status, 201, await created.text());
  const follower = await startNode(options, folder, nats, 'follower', '--follow', 'viewed');
  await until('the servers know each other', SETTLE_S, async () => {
    const response = await fetch(`${follower.base}/`);
    const policy = response.headers.get('content-security-policy') ?? '';
    return policy.includes(owner.base.replace('http', 'ws'));
  });
  return { owner, follower };
}

async function test(folder) {
  const { owner, follower } = await startPair(folder);
  await withBrowser(async (browser) => {
    const size = { width: 840, height: 600 };
    const viewer = await openViewer(browser, `${follower.base}/?session=shared&name=Vi`, size);
    const { page, state, problems } = viewer;
    await until('picture', SETTLE_S, async () => (await state())?.snapshotComplete);
    assert.equal(new URL(page.url()).origin, follower.base, 'the follower shows the block itself');
    await page.keyboard.press('c');
    await page.locator('main[data-carve=ready]').waitFor();
    await drag(viewer, 0.45);
    const both = [owner, follower];
    await equalPage(viewer, follower, 'cut in the page', ({ motions }) => motions > 0);
    const cut = await equalBlocks('the cut at both', both, ({ motions }) => motions > 0);
    assert((await sessionOf(follower.base)).followed, 'the page does not come from a follower');
    await writeFile(join(options.out, 'follower.png'), await page.screenshot());
    await page.keyboard.press('Control+z');
    await equalBlocks('undo at both', both, ({ removed_volume_mm3: mm3 }) => mm3 === 0);
    await page.keyboard.press('Control+y');
    const isRedone = ({ removed_volume_mm3: mm3 }) => mm3 === cut.removed_volume_mm3;
    const redone = await equalBlocks('redo at both', both, isRedone);
    await equalPage(viewer, follower, 'redo in the page', isRedone);
    assert.deepEqual(problems, []);
    await checkHandover(viewer, owner, follower, redone);
  });
  await stopped(follower);
}

if (findNats() === null) {
  console.log('skipped: nats-server is not installed (docker/packages.txt)');
  process.exit(77);
}
await runTest(test, options.out);
