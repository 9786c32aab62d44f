// SPDX-License-Identifier: Apache-2.0
// End-to-end test of tools of one's own: drawn by handles and numbers in the form of a new block and
// in kerf.html, judged by the server, and carved with. See README.md.
//
// node tools_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { openViewer, withBrowser } from './support/browser.mjs';
import { serveFiles } from './support/file_host.mjs';
import { poll, stop, until } from './support/processes.mjs';
import { getJson, optionsOf, runTest, startEmptyServer } from './support/session.mjs';
import { WireViewer } from './support/wire_viewer.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const DESK = { width: 1280, height: 900 };
/** A dovetail: narrow above its widest place. Radius and height of each point, mm. */
const DOVETAIL = [
  [0, 0],
  [5, 0],
  [3, 4],
  [3, 30],
];

const field = (page, what, n) => page.getByLabel(`${what} of point ${n}, mm`, { exact: true });
const outlineOf = async (page) => {
  const count = await page.locator('.profile-points li').count();
  const value = async (what, n) => Number(await field(page, what, n).inputValue());
  const points = [];
  for (let n = 1; n <= count; ++n)
    points.push([await value('Radius', n), await value('Height', n)]);
  return points;
};

/** Makes a dovetail of a new ball end mill: four points by numbers, one of them by its handle. */
async function drawDovetail(page) {
  await page.getByRole('button', { name: 'Add a tool' }).click();
  assert.deepEqual(await outlineOf(page), [
    [0, 0],
    [3, 3],
    [3, 30],
  ]);
  await page.getByRole('button', { name: 'Add a point before point 3' }).click();
  await page.getByLabel('Line or arc to point 2').selectOption('line');
  const points = [...DOVETAIL];
  for (const n of [3, 4]) {
    await field(page, 'Radius', n).fill(String(points[n - 1][0]));
    await field(page, 'Height', n).fill(String(points[n - 1][1]));
  }
  await dragHandle(page, 1, DOVETAIL[1]);
  assert.deepEqual(await outlineOf(page), DOVETAIL, 'the numbers follow the handle');
}

/** Drags the handle of a point to a place of its drawing, mm; the lowest handle is at the tip. */
async function dragHandle(page, n, [r, z]) {
  const drawing = page.locator('.profile-drawing');
  await drawing.scrollIntoViewIfNeeded();
  const middleOf = async (at) => {
    const { x, y, width, height } = await drawing.locator(`[data-n="${at}"]`).boundingBox();
    return [x + width / 2, y + height / 2];
  };
  const [tip, top, from] = [await middleOf(0), await middleOf(3), await middleOf(n)];
  const pixelsPerMm = (tip[1] - top[1]) / DOVETAIL[3][1];
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(tip[0] + 20, tip[1] - 20);
  await page.mouse.move(tip[0] + r * pixelsPerMm, tip[1] - z * pixelsPerMm);
  await page.mouse.up();
}

/** The server names the fault of an outline while it is drawn. */
async function checkFault(page) {
  const create = page.getByRole('button', { name: 'Create', exact: true });
  await field(page, 'Height', 4).fill('2'); // below the point before it
  await page.locator('.price.bad').getByText('profile_mm').waitFor();
  assert(await create.isDisabled());
  await field(page, 'Height', 4).fill(String(DOVETAIL[3][1]));
  await page.getByText(/^0\.\d+\smm: up to .*B of memory, .*s to join$/).waitFor();
  await until('button', SETTLE_S, () => create.isEnabled());
  await create.click();
}

/**
 * Carves with the last tool until there is a cut: the first try may come too early. `isCut` asks for
 * it.
 */
async function carveUntil({ page, state }, isCut) {
  await page.locator('main[data-carve="ready"]').waitFor();
  await page.locator('.carve-tool').last().click();
  await page.getByRole('slider', { name: 'Depth' }).fill('4');
  await page.locator('.canvas').focus();
  for (const y of [0.5, 0.4, 0.6, 0.45, 0.55]) {
    const [left, top, right, bottom] = (await state()).blockBox;
    const at = (x) => [left + x * (right - left), top + y * (bottom - top)];
    await page.mouse.move(...at(0.4));
    await page.mouse.down();
    for (const x of [0.45, 0.5, 0.55]) await page.mouse.move(...at(x), { steps: 6 });
    await page.mouse.up();
    if (await poll(15, isCut)) return;
  }
  throw new Error('the tool cuts nothing');
}

/** A block is created with a tool of one's own, which carves it. */
async function checkLobby(browser, base) {
  const viewer = await openViewer(browser, `${base}/?list&name=Ada`, DESK, {
    reducedMotion: 'reduce',
  });
  const { page, state, problems } = viewer;
  await page.getByRole('button', { name: 'Box' }).click();
  await page.getByRole('button', { name: 'Remove T1' }).click();
  await drawDovetail(page);
  await checkAccessible(page, 'the form with a tool');
  await page.screenshot({
    path: join(options.out, 'tools-lobby.png'),
    fullPage: true,
  });
  await checkFault(page);
  await page.waitForURL(`${base}/?session=relief`);
  await until('block', SETTLE_S, async () => (await state())?.snapshotComplete);
  const wire = new WireViewer(base, 'relief');
  const { tools } = await until('welcome', SETTLE_S, () => wire.welcome);
  wire.close();
  assert(!tools.some(({ id }) => id === 1), 'a tool that was removed is there');
  const { id, shape, profile_mm } = tools.at(-1);
  assert.deepEqual({ id, shape, profile_mm }, { id: 5, shape: 'profile', profile_mm: DOVETAIL });
  await carveUntil(viewer, async () => {
    const session = await getJson(`${base}/v1/sessions/relief`);
    return session.removed_volume_mm3 > 0 && session.participants.some(({ tool }) => tool === 5);
  });
  await page.screenshot({ path: join(options.out, 'tools-carved.png') });
  await page.getByRole('button', { name: /Done|End carving/ }).click();
  // A browser says that the dry run of the faulty outline was refused.
  assert.deepEqual(
    problems.filter((text) => !text.includes('400')),
    [],
  );
  await page.context().close();
}

/** The same without a server. */
async function checkLocal(browser, host) {
  const viewer = await openViewer(browser, `${host.base}/kerf.html`, DESK, {
    reducedMotion: 'reduce',
  });
  const { page, state } = viewer;
  await page.getByText('Tools for carving by hand').click();
  await drawDovetail(page);
  await checkAccessible(page, 'kerf.html with a tool');
  await page.screenshot({ path: join(options.out, 'tools-local.png') });
  await page.getByRole('button', { name: 'New block with these tools' }).click();
  const before = await until('block', SETTLE_S, async () => {
    const now = await state();
    return now.status === 'rest' && now.hash;
  });
  await carveUntil(viewer, async () => {
    const { status, hash, waiting } = await state();
    return status === 'rest' && waiting === 0 && hash !== null && hash !== before;
  });
  await writeFile(join(options.out, 'tools-local-carved.png'), await page.screenshot());
}

async function test(folder) {
  const { server, base } = await startEmptyServer(options, folder);
  const host = await serveFiles(options.web);
  await withBrowser(async (browser) => {
    await checkLobby(browser, base);
    if (existsSync(join(options.web, 'kerf_files.wasm'))) await checkLocal(browser, host);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
