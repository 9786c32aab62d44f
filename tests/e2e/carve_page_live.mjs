// SPDX-License-Identifier: Apache-2.0
// End-to-end test of carving in the page: a newcomer opens an invitation, carves a stroke with the
// mouse over a slow line, undoes and redoes it; a watcher cannot. See README.md.
//
// node carve_page_live.mjs --server PROGRAM --carve PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { placeOf, restingBlock } from './support/block.mjs';
import { openViewer, withBrowser } from './support/browser.mjs';
import { checkFreeBlock } from './support/layout.mjs';
import { run, start, stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { optionsOf, runTest } from './support/session.mjs';
import { slowLine } from './support/slow_line.mjs';
import { stlCorners, volumeOf } from './support/surface.mjs';

const options = optionsOf(['server', 'carve', 'web', 'out']);

const ONE_WAY_MS = 125;
const SETTLE_S = 60; // software WebGL on a busy machine
const SIZES = [
  [390, 844],
  [844, 390],
];
const SCENE = boxScene(
  'Carve here',
  [-20, -15, -10],
  [20, 15, 0],
  [cutter(1, 'ball', 6), cutter(4, 'flat', 8)],
  { machine: { kinematics: 'tool-vector' } },
);
const BLOCK_MM3 = 40 * 30 * 10;
const DEPTH_MM = 1.5; // half the radius of the first tool
/** Of a frame's header, and a type of frame (server/wire/README.md). */
const TYPE_AT = 4;
const STOCK = 8;

/** A server on which everybody needs an invitation, with a session. */
async function startServer(folder) {
  const admin = join(folder, 'admin');
  const server = start(options.server, [
    ...['--listen', '127.0.0.1:0', '--data', join(folder, 'data'), '--web', options.web],
    ...['--admin-token-file', admin],
  ]);
  const base = await until('server address', 20, () => {
    assert.equal(server.code, undefined, `the server exited: ${server.errors}`);
    return server.lines.find((line) => line.startsWith('http'));
  });
  const token = (await readFile(admin, 'ascii')).trim();
  const ask = (path, method = 'GET', body = undefined) =>
    fetch(base + path, {
      method,
      body,
      headers: { authorization: `Bearer ${token}` },
    });
  const created = await ask('/v1/sessions?id=e2e', 'POST', JSON.stringify(SCENE));
  assert.equal(created.status, 201, await created.text());
  return { server, base, ask };
}

/** Opens the link of an invitation. */
async function openInvited(browser, { base, ask }, role, name) {
  const made = await ask(`/v1/sessions/e2e/invitations?role=${role}`, 'POST');
  const link = new URL((await made.json()).link, base);
  link.searchParams.set('name', name);
  return openViewer(browser, link.href, { width: 840, height: 600 });
}

async function session({ ask }) {
  return (await ask('/v1/sessions/e2e')).json();
}

async function stlVolume({ ask }) {
  const response = await ask('/v1/sessions/e2e/model.stl');
  return volumeOf(stlCorners(Buffer.from(await response.arrayBuffer())));
}

/** The session once the server's block, as `isDone` says, is the page's, with the server's meshes. */
function settled(viewer, server, what, isDone) {
  return restingBlock(viewer, () => session(server), what, SETTLE_S, isDone);
}

/** Drags the mouse across the block, in jumps: the tool follows in small steps all the same. */
async function dragAcross(viewer) {
  const { mouse } = viewer.page;
  await mouse.move(...(await placeOf(viewer, 0.3, 0.45)));
  await mouse.move(...(await placeOf(viewer, 0.31, 0.45)));
  await mouse.down();
  await mouse.move(...(await placeOf(viewer, 0.5, 0.5)), { steps: 2 });
  await mouse.move(...(await placeOf(viewer, 0.66, 0.52)), { steps: 2 });
  await mouse.up();
}

/** On phones the bars cover nothing, and axe finds nothing. */
async function checkLayouts(viewer) {
  for (const size of SIZES) {
    await checkFreeBlock(viewer, size, ['.bar', '.toolbar', '.panel', '.carve-bar']);
    await checkAccessible(viewer.page, `the page while one carves, ${size.join(' × ')}`);
    const file = join(options.out, `carve-${size[0]}.png`);
    await writeFile(file, await viewer.page.screenshot());
  }
}

/** How deep the block is cut that the page displays. */
function depthDisplayed(page) {
  return page.evaluate(() => {
    const corners = window.kerf.surface();
    let depth = 0;
    for (let n = 0; n < corners.length; n += 3) {
      const [x, y, z] = corners.slice(n, n + 3);
      const isInside = Math.abs(x) < 19 && Math.abs(y) < 14 && z > -9;
      if (isInside) depth = Math.max(depth, -z);
    }
    return depth;
  });
}

const isUncut = ({ removed_volume_mm3: mm3 }) => Math.abs(mm3) < 1e-6;

/** The export of the session, carved by kerf-carve, is the block. */
async function checkExport(server, folder, { state_hash: hash }) {
  const response = await server.ask('/v1/sessions/e2e/program.ngc');
  await writeFile(join(folder, 'program.ngc'), await response.text());
  await writeFile(join(folder, 'scene.json'), JSON.stringify(SCENE));
  await run(options.carve, [
    ...['--scene', join(folder, 'scene.json'), '--program', join(folder, 'program.ngc')],
    ...['--report', join(folder, 'report.json')],
  ]);
  const report = JSON.parse(await readFile(join(folder, 'report.json'), 'utf8'));
  assert.equal(report.state_hash, hash, 'kerf-carve makes another block of the export');
}

/**
 * Notes when the server's stock has come for the page's copy, which it does once there is a tool. What is
 * carved before cannot be undone by the page alone. To be called before the page carves.
 */
function noteStock(page) {
  const note = { hasCome: false };
  page.on('websocket', (socket) =>
    socket.on('framereceived', ({ payload }) => {
      note.hasCome ||= typeof payload !== 'string' && payload[TYPE_AT] === STOCK;
    }),
  );
  return note;
}

/** Leaves, and joins again as the same participant, whose copy gets the server's stock. */
async function comeBack(page) {
  await page.keyboard.press('Escape');
  await page.locator('main[data-carve=off]').waitFor();
  await page.keyboard.press('c');
  await page.locator('main[data-carve=ready]').waitFor();
}

/** A section would hide what is carved: its panel and carving close each other. */
async function checkExcludesSections({ page }) {
  await page.keyboard.press('i');
  await page.getByRole('region', { name: 'Sections and measurements' }).waitFor();
  assert.equal(await page.locator('.carve-bar').count(), 0, 'one carves beside a section');
  await page.keyboard.press('c');
  await page.locator('main[data-carve=ready]').waitFor();
  assert.equal(await page.locator('.inspect:visible').count(), 0, 'a section stays');
}

/** Cuts the line; waits until the page has lost its connection and joined again. */
async function cutLine(page, line) {
  // Noted in the page: on a busy machine it may have joined again before it is asked.
  await page.evaluate(() => {
    const main = document.querySelector('main');
    window.hasLost = main.dataset.carve === 'lost';
    new MutationObserver(() => (window.hasLost ||= main.dataset.carve === 'lost')).observe(main, {
      attributeFilter: ['data-carve'],
    });
  });
  line.cut();
  await until('loss of the connection', SETTLE_S, () => page.evaluate(() => window.hasLost));
  await page.locator('main[data-carve=ready]').waitFor();
}

/**
 * A second stroke in the groove is displayed though nothing of the server comes. Then the connection
 * breaks, which leaves no difference.
 */
async function checkAlone(viewer, server, line) {
  const { page, state } = viewer;
  const { motions } = await session(server);
  line.hold();
  const before = (await state()).tiles;
  await dragAcross(viewer);
  await until('the cut', SETTLE_S, async () => (await depthDisplayed(page)) > 1.5 * DEPTH_MM);
  assert.deepEqual((await state()).tiles, before, "a mesh of the server's has come");
  assert((await state()).copyTiles > 0);
  await writeFile(join(options.out, 'carve-alone.png'), await page.screenshot());
  await cutLine(page, line);
  await settled(viewer, server, 'stroke after a loss', (block) => block.motions > motions);
}

/** An undo is displayed though nothing of the server comes. Then the connection breaks. */
async function undoAlone({ page, state }, server, line) {
  line.hold();
  const { tiles } = await state();
  await page.keyboard.press('Control+z');
  await until('an undo', SETTLE_S, async () => (await depthDisplayed(page)) < 0.5 * DEPTH_MM);
  assert.deepEqual((await state()).tiles, tiles, "a mesh of the server's has come");
  await until('undo at the server', SETTLE_S, async () => isUncut(await session(server)));
  await cutLine(page, line);
}

/** Drags the mouse through fresh stock; returns how far the tool was behind, pixels. */
async function quickStroke(viewer, y) {
  const { page } = viewer;
  const spring = page.locator('.carve-spring');
  await page.evaluate(() => {
    window.behindPx = 0;
    const measured = () => {
      const width = document.querySelector('.carve-spring')?.offsetWidth ?? 0;
      window.behindPx = Math.max(window.behindPx, width);
    };
    const changes = { attributeFilter: ['style'], childList: true, subtree: true };
    new MutationObserver(measured).observe(document.querySelector('main'), changes);
  });
  const places = [];
  for (const x of [0.3, 0.32, 0.34, 0.45, 0.56, 0.67]) places.push(await placeOf(viewer, x, y));
  const [first, ...others] = places;
  await page.mouse.move(...first);
  await page.mouse.down();
  // As fast as a hand: the page is not asked between them, because a force counts for 250 ms only.
  for (const place of others) {
    await page.mouse.move(...place);
    await new Promise((resolve) => setTimeout(resolve, 25));
  }
  await until('the tool at the pointer', SETTLE_S, () => spring.isHidden());
  await page.mouse.up();
  return page.evaluate(() => window.behindPx);
}

/** The force holds the tool back, as the user has chosen, also after the page is loaded again. */
async function checkDrag(viewer, server) {
  const { page } = viewer;
  const drag = page.getByRole('button', { name: /^Resistance: / });
  assert.equal(await drag.textContent(), 'Resistance: off');
  const none = await quickStroke(viewer, 0.38);
  assert.equal(none, 0);
  for (const strength of ['light', 'strong']) {
    await page.keyboard.press('d');
    assert.equal(await drag.textContent(), `Resistance: ${strength}`);
  }
  const { motions } = await session(server);
  const strong = await quickStroke(viewer, 0.62);
  assert(strong >= 6, `the tool was ${strong} px behind at most`);
  await settled(viewer, server, 'dragged stroke', (block) => block.motions > motions);
  await drag.click();
  assert.equal(await drag.textContent(), 'Resistance: off');
  console.log(`dragged: up to ${strong} px behind`);
  assert.equal(await page.evaluate(() => localStorage.getItem('kerf.drag')), 'off');
}

/**
 * On a busy machine a line may be held for longer than the 10 s after which a page tries it again;
 * the browser reports that such a try was cut.
 */
function isOfHeldLine(text) {
  return /^WebSocket connection to .* failed|net::ERR_(EMPTY_RESPONSE|CONNECTION_)/.test(text);
}

async function checkSculptor(browser, server, line, folder) {
  const near = { ...server, base: line.base };
  const viewer = await openInvited(browser, near, 'sculptor', 'Grace');
  const { page, problems } = viewer;
  await until('picture', SETTLE_S, async () => {
    const marks = await page.evaluate(() => window.kerf?.marks);
    return marks?.picture && (await viewer.state()).snapshotComplete;
  });
  assert(Math.abs((await stlVolume(server)) - BLOCK_MM3) < 0.01);
  const stock = noteStock(page);
  await page.keyboard.press('c');
  await page.locator('main[data-carve=ready]').waitFor();
  await page.getByRole('button', { name: /Grace \(you\).*sculptor · ball 6 mm/ }).waitFor();
  assert.equal(await page.getByText('Grace (you)').count(), 1, 'one person is listed twice');
  await page.mouse.move(...(await placeOf(viewer, 0.3, 0.45)));
  await until('stock of the server', SETTLE_S, () => stock.hasCome);
  await settled(viewer, server, 'stock of the server in the page', isUncut);
  await dragAcross(viewer);
  const isCut = ({ removed_volume_mm3: mm3 }) => mm3 > 0;
  const cut = await settled(viewer, server, 'cut', isCut);
  const volume = await stlVolume(server);
  // A groove of a ball, some 12 to 30 mm long: the cap of the ball below the surface is its section.
  const section = 9 * Math.acos(1 - DEPTH_MM / 3) - (3 - DEPTH_MM) * Math.sqrt(9 - 1.5 ** 2);
  const length = (BLOCK_MM3 - volume) / section;
  assert(length > 12 && length < 30, `${length} mm`);
  await checkExport(server, folder, cut);
  console.log(`a stroke of ${cut.motions} motions and ${length.toFixed(1)} mm: ${cut.state_hash}`);

  await undoAlone(viewer, server, line);
  await settled(viewer, server, 'undo', isUncut);
  assert(Math.abs((await stlVolume(server)) - BLOCK_MM3) < 0.01);
  await comeBack(page);
  await settled(viewer, server, 'undone block of one who has left and come back', isUncut);
  await page.getByRole('button', { name: 'Redo' }).last().click();
  await page.getByText('Your stroke was redone.').waitFor();
  await settled(viewer, server, 'redo', ({ state_hash: hash }) => hash === cut.state_hash);
  await checkAlone(viewer, server, line);
  await checkDrag(viewer, server);

  await checkLayouts(viewer);
  await checkExcludesSections(viewer);
  await page.keyboard.press('Escape');
  await until('no agent', SETTLE_S, async () => {
    const { participants } = await session(server);
    return participants.every(({ kind }) => kind === 'viewer');
  });
  assert.deepEqual(
    problems.filter((text) => !isOfHeldLine(text)),
    [],
  );
}

async function checkWatcher(browser, server) {
  const { page, problems } = await openInvited(browser, server, 'watcher', 'Mary');
  const button = page.getByRole('button', { name: 'Carve' });
  await page
    .locator('button[title="Carve: Your role, watcher, does not allow carving."]')
    .waitFor();
  assert.equal(await button.getAttribute('aria-disabled'), 'true');
  await page.keyboard.press('c');
  await page.getByText('Your role, watcher, does not allow carving.').waitFor();
  assert.equal(await page.locator('.carve-bar').count(), 0);
  assert.deepEqual(problems, []);
}

async function test(folder) {
  const server = await startServer(folder);
  const line = await slowLine(server.base, ONE_WAY_MS);
  await withBrowser(async (browser) => {
    await checkSculptor(browser, server, line, folder);
    await checkWatcher(browser, server);
  });
  assert.equal(await stop(server.server), 0, server.server.errors);
}

await runTest(test, options.out);
