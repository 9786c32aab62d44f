// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the timeline: the page goes to the past and back, shows the blocks of both,
// names, undoes and branches. See README.md.
//
// node past_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { countPixels, untilStill } from './support/pictures.mjs';
import { checkFreeBlock } from './support/layout.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { carveProgram, getJson, optionsOf, runTest, startServer } from './support/session.mjs';
import { assertSameSurface } from './support/surface.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const SIZES = [
  [390, 844],
  [844, 390],
  [1000, 700],
];
/** Tiles have vertices of 16 bits, which is coarser than an STL. */
const WELD_MM = 0.004;
const SCENE = boxScene('History', [0, 0, -6], [24, 16, 0], [cutter(1, 'ball', 4)]);

/** A zigzag, as one program of the session. */
async function carve(session, y) {
  const lines = ['G21 G90', 'T1 M6', 'S10000 M3', `G0 X2 Y${y} Z5`, 'G1 Z-2 F600'];
  for (let x = 2; x < 22; x += 0.5) lines.push(`G1 X${x} Y${y + 4 * (x % 1)}`);
  await carveProgram(
    session,
    [...lines, 'G0 Z5', 'M30', ''].join('\n'),
    'name=zigzag.ngc&speed=20',
  );
}

/** Waits until the page shows a record, or the present, and compares its surface with the server's. */
async function checkBlock({ page, state }, session, record) {
  const shown = await until(`block of ${record ?? 'now'}`, SETTLE_S, async () => {
    const now = await state();
    const isThere = (now.past?.record ?? null) === record && (now.past?.rate ?? 0) === 0;
    return isThere && now.settled && now.snapshotComplete && now;
  });
  const at = record === null ? '' : `?at=${record}`;
  const response = await fetch(`${session}/model.stl${at}`);
  assert.equal(response.status, 200);
  assert.equal(response.headers.get('etag')?.includes(shown.hash), true, 'another state hash');
  const stl = Buffer.from(await response.arrayBuffer());
  const corners = await page.evaluate(() => window.kerf.surface());
  const facts = assertSameSurface(corners, stl, SCENE.stock, WELD_MM);
  const { triangles, cut, volume } = facts;
  console.log(`${record ?? 'now'}: ${triangles} triangles, ${cut} cut vertices, ${volume} mm³`);
  return facts;
}

/** The parts of the journal that the page has fetched. */
function spansOf(page) {
  return page.evaluate(() =>
    performance
      .getEntriesByType('resource')
      .map(({ name }) => name)
      .filter((name) => name.includes('/records?')),
  );
}

function playhead(page) {
  return page.getByRole('slider', { name: 'Position on the timeline' });
}

async function scrub(page, parts) {
  const box = await playhead(page).boundingBox();
  const y = box.y + 18;
  await page.mouse.move(box.x + parts[0] * box.width, y);
  await page.mouse.down();
  for (const part of parts) await page.mouse.move(box.x + part * box.width, y, { steps: 4 });
  await page.mouse.up();
  return Number(await playhead(page).getAttribute('aria-valuenow'));
}

/** Timeline and banner cover neither the block nor anything else. */
async function checkLayouts(viewer) {
  const boxes = ['.bar', '.toolbar', '.panel', '.timeline', '.past-banner'];
  for (const size of SIZES) {
    await checkFreeBlock(viewer, size, boxes);
    const file = join(options.out, `past-${size[0]}.png`);
    await writeFile(file, await viewer.page.screenshot());
  }
}

async function checkTimeline(viewer, session) {
  const { page, state } = viewer;
  await until('picture', SETTLE_S, async () => (await state())?.snapshotComplete);
  const now = await checkBlock(viewer, session, null);
  await page.keyboard.press('t');
  await page.getByRole('group', { name: 'Playback' }).waitFor();
  await until('strokes', SETTLE_S, async () => {
    const last = await playhead(page).getAttribute('aria-valuemax');
    return Number(last) > 20;
  });
  const record = await scrub(page, [0.8, 0.3]);
  const past = await checkBlock(viewer, session, record);
  assert(past.volume > now.volume + 10, 'the past has as little material as the present');
  assert((await spansOf(page)).length > 0, 'the past is the server’s');
  await page.getByText('The past', { exact: true }).waitFor();
  await playhead(page).press('Shift+ArrowLeft'); // 100 motions, to the beginning at most
  await playhead(page).press('ArrowRight');
  await checkBlock(viewer, session, Math.max(0, record - 100) + 1);
  await playhead(page).press('Home');
  await page.getByLabel('Playback speed').selectOption('0.25');
  // Asked for in each frame of the page: on a busy machine a program may end between two questions.
  const showsTool = () => {
    const { past: place, participants } = window.kerf.state();
    const plays = place?.rate > 0 && place.record > 1;
    return plays && participants.some(({ name }) => name === 'zigzag.ngc');
  };
  await Promise.all([
    page.waitForFunction(showsTool, null, { timeout: 1000 * SETTLE_S }),
    page.getByRole('button', { name: 'Play', exact: true }).click(),
  ]);
  await scrub(page, [0.3]);
  await checkBlock(viewer, session, record);
  return record;
}

/** Both states are in one picture: right of the border the kept one, left of it the one that is shown. */
async function checkCompare(viewer, session, record) {
  const { page, state } = viewer;
  await page.locator('input[name="material"]').nth(2).check({ force: true }); // cuts are not blue
  // The camera follows the free part of the page, which the banner of the past makes smaller.
  const boxAtRest = async () => {
    await untilStill(viewer);
    return (await state()).blockBox.map(Math.round);
  };
  const cut = async () => {
    const [left, top, right, bottom] = await boxAtRest();
    const [width, height] = [right - left, bottom - top];
    const box = [left, top, width, height];
    return (await countPixels(viewer, box, { leastRedOverBlue: -35 })) / (width * height);
  };
  const border = page.getByRole('slider', {
    name: 'Divider between the two states',
  });
  // A paused past has no tool; one of before may still be in the picture, and is not blue either.
  const withoutTools = () =>
    until('a picture without tools', SETTLE_S, async () => {
      await nextFrames(page);
      return (await page.locator('.tool-label:visible').count()) === 0;
    });
  await withoutTools();
  const past = await cut();
  await page.getByRole('button', { name: 'Compare' }).click();
  await playhead(page).press('End');
  await checkBlock(viewer, session, null);
  const [left, top, right, bottom] = await boxAtRest();
  const drag = async (x) => {
    const box = await border.boundingBox();
    await page.mouse.move(box.x + box.width / 2, (top + bottom) / 2);
    await page.mouse.down();
    await page.mouse.move(x, (top + bottom) / 2);
    await page.mouse.up();
    await nextFrames(page);
  };
  await drag(left - 40);
  await withoutTools();
  const kept = await cut();
  console.log(`shares of cuts: ${past} in the past, ${kept} kept`);
  assert(Math.abs(kept / past - 1) < 0.05, `a share of ${kept} shows kept cuts, ${past} then`);
  await drag(right + 40);
  const now = await cut();
  assert(now > 1.1 * past, `a share of ${now} shows cuts now, ${past} then`);
  await drag((left + right) / 2);
  const both = await cut();
  assert(both > past && both < now, `a share of ${both} with both states`);
  await writeFile(join(options.out, 'compare.png'), await page.screenshot());
  await page.getByRole('button', { name: 'Compare' }).click();
  assert.equal(await border.isVisible(), false);
  await scrub(page, [0.3]);
  await checkBlock(viewer, session, record);
}

/** Names the block that is shown, and undoes the stroke that was pressed. */
async function checkChanges({ page }, session, record) {
  await page.getByRole('button', { name: 'Save a version' }).click();
  await page.getByLabel('Name of the version').fill('Half done');
  await page.keyboard.press('Enter');
  await page.getByText('“Half done” was saved.').waitFor();
  const { versions } = await getJson(`${session}/versions`);
  assert.deepEqual(
    versions.map((version) => [version.name, version.record]),
    [['Half done', record]],
  );
  await page.getByRole('button', { name: /^Undo this stroke by/ }).click();
  await page.getByText('was undone.').waitFor();
  const { strokes } = await getJson(`${session}/strokes`);
  const [undone, ...others] = strokes.filter((stroke) => stroke.undone);
  assert.deepEqual(others, []);
  assert(undone.id <= record && undone.last >= record, 'another stroke was undone');
}

async function checkBranch({ page, state }, base, record) {
  await page.getByRole('button', { name: 'Branch from here' }).click();
  await page.getByLabel('ID of the new session').fill('branched');
  await page.keyboard.press('Enter');
  await until('the new session', SETTLE_S, async () => (await state())?.session === 'branched');
  const { parent } = await getJson(`${base}/v1/sessions/branched`);
  assert.deepEqual([parent.session, parent.record], ['past', record]);
}

/** The page's words for a state that is the server's. */
const verified = (record) => `Verified up to step ${record.toLocaleString('en')}`;

/** The page replays the journal by itself, from files that caches may keep, and finds the server's state. */
async function checkVerified({ page }, session) {
  await page.getByRole('button', { name: 'Verify', exact: true }).click();
  const { record } = await getJson(`${session}/replay`);
  await page.getByText(verified(record)).waitFor({ timeout: 1000 * SETTLE_S });
  const [span] = await spansOf(page);
  const { headers } = await fetch(span);
  assert.equal(headers.get('cache-control'), 'public, max-age=31536000, immutable');
  await writeFile(join(options.out, 'verified.png'), await page.screenshot());
}

/** A downloaded journal is replayed without a server: same state, any record, its surface. */
async function checkFile(browser, base, session) {
  const { record, state_hash } = await getJson(`${session}/replay`); // stores the hash
  const journal = await fetch(`${session}/journal`);
  const file = {
    name: 'past.kerf',
    mimeType: 'application/octet-stream',
    buffer: Buffer.from(await journal.arrayBuffer()),
  };
  const viewer = await openViewer(browser, `${base}/kerf.html`, {
    width: 1440,
    height: 900,
  });
  const { page, state } = viewer;
  await page.locator('input[type="file"]').setInputFiles(file);
  const rest = (carved) =>
    until(`record ${carved}`, SETTLE_S, async () => {
      const now = await state();
      if (now.status === 'failed') throw new Error(now.problem);
      return now.status === 'rest' && now.waiting === 0 && now.carved === carved && now;
    });
  assert.equal((await rest(record)).hash, state_hash);
  await page.getByText(verified(record)).waitFor();
  await writeFile(join(options.out, 'kerf-file.png'), await page.screenshot());
  const half = Math.floor(record / 2);
  await page.getByRole('slider', { name: 'Position in the program' }).fill(String(half));
  const then = await fetch(`${session}/model.stl?at=${half}`);
  assert(then.headers.get('etag').includes((await rest(half)).hash), 'another state in the past');
  const stl = Buffer.from(await then.arrayBuffer());
  const corners = await page.evaluate(() => window.kerf.surface());
  assertSameSurface(corners, stl, SCENE.stock, WELD_MM);
  await page.getByLabel('Playback speed').selectOption('64');
  await page.getByRole('button', { name: 'Play', exact: true }).click();
  assert.equal((await rest(record)).hash, state_hash, 'another state after playing');
  await page.setViewportSize({ width: 390, height: 844 });
  await writeFile(join(options.out, 'kerf-file-phone.png'), await page.screenshot());
  assert.deepEqual(viewer.problems, []);
}

async function test(folder) {
  const { server, base, session } = await startServer(options, folder, 'past', SCENE);
  await carve(session, 4);
  await carve(session, 9);
  await withBrowser(async (browser) => {
    const [width, height] = SIZES.at(-1);
    const viewer = await openViewer(browser, `${base}/?session=past&quality=full`, {
      width,
      height,
    });
    const record = await checkTimeline(viewer, session);
    await checkCompare(viewer, session, record);
    await checkLayouts(viewer);
    await checkChanges(viewer, session, record);
    await viewer.page.locator('.past-back').click();
    await checkBlock(viewer, session, null); // without the stroke that was undone
    await checkVerified(viewer, session);
    await checkFile(browser, base, session);
    assert.equal(await viewer.page.locator('.past-back').isVisible(), false);
    await viewer.page.getByLabel('Versions', { exact: true }).selectOption('Half done');
    await checkBlock(viewer, session, record);
    await checkBranch(viewer, base, record);
    assert.deepEqual(viewer.problems, []);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
