// SPDX-License-Identifier: Apache-2.0
// End-to-end test of a page whose server stops, and of one whose server is killed: page, picture,
// camera and hand go on at another server of the cluster. See README.md.
//
// node moved_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { restingBlock } from './support/block.mjs';
import { openViewer, withBrowser } from './support/browser.mjs';
import { findNats, startNats, startNode } from './support/cluster.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { getJson, optionsOf, runTest } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 90; // software WebGL on a busy machine
const ROUNDED_MM = 1e-6; // the controls compute the camera's place again in each frame
const PATH = '/v1/sessions/shared';
const SCENE = boxScene('Shared', [-20, -15, -10], [20, 15, 0], [cutter(1, 'ball', 6)]);

/** Starts servers that know each other, the first with the session. */
async function startServers(folder) {
  const nats = await startNats(findNats(), folder);
  const servers = [];
  for (const name of ['first', 'second', 'third'])
    servers.push(await startNode(options, folder, nats, name));
  const [first, ...others] = servers;
  const created = await fetch(`${first.base}/v1/sessions?id=shared&here=1`, {
    method: 'POST',
    body: JSON.stringify(SCENE),
  });
  assert.equal(created.status, 201, await created.text());
  await until('the first knows the others', SETTLE_S, async () => {
    const response = await fetch(`${first.base}/`);
    const policy = response.headers.get('content-security-policy') ?? '';
    return others.every(({ base }) => policy.includes(base));
  });
  return servers;
}

/** The one of the servers that has the session. */
function ownerOf(servers) {
  return until('a server has the session', SETTLE_S, async () => {
    for (const server of servers) {
      const response = await fetch(server.base + PATH, {
        redirect: 'manual',
      }).catch(() => null);
      if (response?.status === 200) return server;
    }
    return null;
  });
}

/** The block's box in the page once the picture has come to rest. */
async function restingBox({ state }) {
  let [box, rests] = [null, 0];
  await until('a picture at rest', SETTLE_S, async () => {
    const { blockBox } = await state();
    const moves = box === null || blockBox.some((side, n) => Math.abs(side - box[n]) > 0.01);
    rests = moves ? 0 : rests + 1;
    box = blockBox;
    return rests === 5;
  });
  return box;
}

/** Drags the mouse across the block; `y` is a share of the block's box. */
async function drag(viewer, y) {
  const { page } = viewer;
  const [left, top, right, bottom] = await restingBox(viewer);
  const place = (x) => [left + x * (right - left), top + y * (bottom - top)];
  await page.mouse.move(...place(0.35));
  await page.mouse.down();
  for (const x of [0.45, 0.55, 0.65]) await page.mouse.move(...place(x));
  await page.mouse.up();
}

/** Waits until page, its copy of the block and a server have the same block after a stroke. */
async function strokeAt(viewer, server, y) {
  const before = (await getJson(server.base + PATH)).motions;
  await drag(viewer, y);
  const read = () => getJson(server.base + PATH);
  const isCut = ({ motions }) => motions > before;
  return restingBlock(viewer, read, 'cut in server and page', SETTLE_S, isCut);
}

/** Where the camera is and looks. */
const numbersOf = ({ camera: { eye, target } }) => [...eye, ...target];

/** The names of all who could carve: a hand that joined as another would be there twice. */
async function carversOf(server) {
  const { authors } = await getJson(`${server.base}${PATH}/authors`);
  return authors.map(({ name }) => name);
}

/** Carves at the server that has the session now, in the page of the first one. */
async function checkMoved(viewer, server, first, camera, y) {
  const { page, state } = viewer;
  await until('the page watches and carves', SETTLE_S, async () => {
    // The page may still show the previous server: this one has its hand.
    const { participants } = await getJson(server.base + PATH);
    if (!participants.some(({ kind }) => kind === 'agent')) return false;
    const { status } = await state();
    return status === 'connected' && (await page.locator('main[data-carve=ready]').count()) > 0;
  });
  const cut = await strokeAt(viewer, server, y);
  assert.equal(await page.evaluate(() => window.kerfTestMark), 'kept', 'the page was loaded again');
  assert.equal(new URL(page.url()).origin, first.base);
  const now = numbersOf(await state());
  const isThere = camera.every((value, k) => Math.abs(value - now[k]) < ROUNDED_MM);
  assert(isThere, `the camera has moved from ${camera} to ${now}`);
  assert.deepEqual(await carversOf(server), ['Vi']);
  return cut;
}

/** The timeline, which was open, asks the server that has the session now. */
async function checkRequests({ page }, server) {
  await page.waitForResponse(
    (response) => response.url().startsWith(`${server.base}${PATH}/strokes`) && response.ok(),
  );
}

/** A chunk that was never loaded is not there: the page says so, and where it can be opened. */
async function checkUnloaded({ page }, server) {
  await page.getByRole('button', { name: 'NC programs' }).click();
  await page.getByText(`Open the page at ${server.base}`).waitFor();
}

async function test(folder) {
  const [first, ...others] = await startServers(folder);
  await withBrowser(async (browser) => {
    const size = { width: 1200, height: 960 };
    const viewer = await openViewer(browser, `${first.base}/?session=shared&name=Vi`, size);
    const { page, state } = viewer;
    await until('picture', SETTLE_S, async () => (await state())?.snapshotComplete);
    await page.evaluate(() => (window.kerfTestMark = 'kept'));
    await page.getByRole('button', { name: 'Timeline' }).click();
    await page.locator('.timeline').waitFor();
    await page.locator('canvas.canvas').focus();
    await page.keyboard.press('c');
    await page.locator('main[data-carve=ready]').waitFor();
    await page.keyboard.press('f'); // between the panels
    for (let n = 0; n < 3; ++n) await page.keyboard.press('ArrowRight');
    const untouched = (await getJson(first.base + PATH)).state_hash;
    await strokeAt(viewer, first, 0.38);
    const camera = numbersOf(await state());
    assert.deepEqual(viewer.problems, []);

    assert.equal(await stop(first.server), 0, first.server.errors);
    const heir = await ownerOf(others);
    await checkMoved(viewer, heir, first, camera, 0.46);
    await checkRequests(viewer, heir);
    await checkUnloaded(viewer, heir);
    await writeFile(join(options.out, 'moved.png'), await page.screenshot());

    await stop(heir.server, 'SIGKILL');
    const last = await ownerOf(others.filter((server) => server !== heir));
    await checkMoved(viewer, last, first, camera, 0.54);
    for (let n = 0; n < 3; ++n) await page.keyboard.press('Control+z');
    await until('all is undone', SETTLE_S, async () => {
      const { state_hash: hash } = await getJson(last.base + PATH);
      return hash === untouched && (await state()).hash === untouched;
    });
    assert.equal(await stop(last.server), 0, last.server.errors);
  });
}

if (findNats() === null) {
  console.log('skipped: nats-server is not installed (docker/packages.txt)');
  process.exit(77);
}
await runTest(test, options.out);
