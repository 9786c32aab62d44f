// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the check of a session: the page verifies the server's state, then what came
// behind it only; and where its replay is another, it names the first record at which they part. A
// picture behind a relay that withholds mesh frames is neither live nor verified until it is there.
// See README.md.
//
// node check_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { openViewer, withBrowser } from './support/browser.mjs';
import { meshRelay } from './support/mesh_relay.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { carveProgram, getJson, optionsOf, runTest, startServer } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const VIEWPORT = { width: 1000, height: 700 };
const SCENE = boxScene('Checked', [0, 0, -6], [24, 16, 0], [cutter(1, 'ball', 4)]);

function groove(session, y) {
  const lines = ['G21 G90', 'T1 M6', 'S10000 M3', `G0 X2 Y${y} Z5`, 'G1 Z-2 F600'];
  for (let x = 2; x < 22; x += 0.5) lines.push(`G1 X${x}`);
  return carveProgram(session, [...lines, 'G0 Z5', 'M30', ''].join('\n'), 'name=groove.ngc');
}

async function enter(browser, base, change) {
  const viewer = await openViewer(browser, 'about:blank', VIEWPORT);
  await change?.(viewer.page);
  await viewer.page.goto(`${base}/?session=checked`);
  await until('picture', SETTLE_S, async () => (await viewer.state())?.snapshotComplete);
  return viewer;
}

async function press({ page }) {
  await page.getByRole('button', { name: 'Verify', exact: true }).click();
}

const text = (record) => record.toLocaleString('en');

async function checkVerified(viewer, session) {
  await press(viewer);
  const { record } = await getJson(`${session}/replay`);
  await viewer.page
    .getByText(`Verified up to step ${text(record)}`)
    .waitFor({ timeout: 1000 * SETTLE_S });
  return record;
}

/** How many files of a kind the page has asked for. */
function countAsked(page, what) {
  return page.evaluate(
    (part) =>
      performance.getEntriesByType('resource').filter(({ name }) => name.includes(part)).length,
    what,
  );
}

/** From a record on the server says other hashes, as if its kernel had cut otherwise. */
async function differFrom(page, first) {
  const changed = ({ record, state_hash: hash, ...others }) => ({
    ...others,
    record,
    state_hash: record >= first ? [...hash].reverse().join('') : hash,
  });
  await page.route(/\/(replay|hashes)(\?|$)/, async (route) => {
    const response = await route.fetch();
    const body = await response.json();
    const json = body.hashes ? { hashes: body.hashes.map(changed) } : changed(body);
    await route.fulfill({ response, json });
  });
}

async function checkParting(browser, base, last) {
  const parting = Math.floor(0.4 * last);
  const viewer = await enter(browser, base, (page) => differFrom(page, parting));
  await press(viewer);
  const first = viewer.page.getByText(/^The first difference is/);
  await first.waitFor({ timeout: 1000 * SETTLE_S });
  assert.equal(await first.textContent(), `The first difference is at step ${text(parting)}.`);
  await viewer.page.getByText(`Differs at step ${text(last)}:`).waitFor();
  await first.scrollIntoViewIfNeeded();
  await writeFile(join(options.out, 'check-differs.png'), await viewer.page.screenshot());
}

/** The badges of the connection and of the check. */
function saidOf({ page }) {
  return page.evaluate(() => ({
    badge: document.querySelector('.badge')?.dataset.state,
    isComplete: document.querySelector('.hash code')?.classList.contains('settled'),
    verdict: document.querySelector('.check-result')?.dataset.verdict,
  }));
}

async function checkRelay(browser, base, session) {
  const relay = await meshRelay(base);
  const viewer = await enter(browser, relay.base);
  await checkVerified(viewer, session);
  relay.withhold(true);
  await groove(session, 12);
  await until('a withheld frame', SETTLE_S, () => relay.withheld() > 0);
  await until('a picture that is behind', SETTLE_S, async () => {
    const { badge, isComplete } = await saidOf(viewer);
    return badge !== 'connected' && !isComplete;
  });
  await press(viewer);
  await viewer.page
    .getByText('Not verified: the view is behind the block')
    .waitFor({ timeout: 1000 * SETTLE_S });
  await writeFile(join(options.out, 'check-behind.png'), await viewer.page.screenshot());
  relay.withhold(false);
  const { record } = await getJson(`${session}/replay`);
  await viewer.page
    .getByText(`Verified up to step ${text(record)}`)
    .waitFor({ timeout: 1000 * SETTLE_S });
  const { badge, isComplete, verdict } = await saidOf(viewer);
  assert.deepEqual([badge, isComplete, verdict], ['connected', true, 'verified']);
  await viewer.page.context().close();
  return record;
}

async function test(folder) {
  const { server, base, session } = await startServer(options, folder, 'checked', SCENE);
  await groove(session, 4);
  await withBrowser(async (browser) => {
    const viewer = await enter(browser, base);
    const before = await checkVerified(viewer, session);
    await groove(session, 9);
    const after = await checkVerified(viewer, session);
    assert(after > before, 'nothing was carved');
    assert.equal(await countAsked(viewer.page, '/origin?'), 1, 'it was replayed from the start');
    const last = await checkRelay(browser, base, session);
    await checkParting(browser, base, last);
    assert.deepEqual(viewer.problems, []);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
