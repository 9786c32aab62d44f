// SPDX-License-Identifier: Apache-2.0
// End-to-end test of carving by hand in kerf.html, without a server: strokes with the mouse, undo
// and redo. The .kerf file that the page writes is replayed by kerf-server to the same hash, served by
// it, and opened by the page, which carves on; unsaved strokes are kept. Two continuations of one file
// are merged. See README.md.
//
// node hand_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFile, mkdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { openViewer, withBrowser } from './support/browser.mjs';
import { photograph } from './support/pictures.mjs';
import { dropFiles } from './support/drop.mjs';
import { serveFiles } from './support/file_host.mjs';
import { carvedMore, checkReplayed, isJoined, savedTo, settled } from './support/local_page.mjs';
import { start, stop, until } from './support/processes.mjs';
import { optionsOf, runFilesTest } from './support/session.mjs';
import { clashesIn } from './support/texts.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const DESK = { width: 1280, height: 800 };
const PHONE = { width: 390, height: 844 };
const OTHER = 'G21 G90\nG0 X1\nM30\n';

/** A block that nobody gave a file for: strokes, undo, redo. Returns its last state. */
async function checkHand(viewer) {
  const { page } = viewer;
  await isJoined(viewer);
  const untouched = await settled(viewer, 'block', () => true);
  assert.equal(untouched.removedMm3, 0);
  const first = await carvedMore(viewer, untouched, 0.4);
  assert(first.removedMm3 > 10, `a stroke removed ${first.removedMm3} mm³`);
  await photograph(viewer, join(options.out, 'hand.png'));
  await checkAccessible(page, 'the page while a hand carves');
  assert.deepEqual(
    await clashesIn(page, 'main > :is(.bar, .main-actions, .toolbar, .panel, .carve-bar)'),
    [],
  );
  const second = await carvedMore(viewer, first, 0.6);
  await page.keyboard.press('Control+z');
  await settled(viewer, 'undo', ({ hash }) => hash === first.hash);
  await page.keyboard.press('Control+z');
  await settled(viewer, 'undo of the first', ({ hash }) => hash === untouched.hash);
  await page.keyboard.press('Control+z'); // there is nothing more
  await page.getByText('There is no stroke to undo.').waitFor();
  assert.equal(await page.getByRole('heading', { name: 'Program' }).count(), 0);
  await page.getByRole('heading', { name: 'History' }).waitFor();
  await page.keyboard.press('Control+Shift+z');
  await settled(viewer, 'redo', ({ hash }) => hash === first.hash);
  await page.keyboard.press('Control+Shift+z');
  return settled(viewer, 'redo of the second', ({ hash }) => hash === second.hash);
}

/** A journal that another has begun: strokes are added, none of what it had is lost. */
async function checkReopened(viewer, file, before, y = 0.5) {
  await dropFiles(viewer.page, { 'again.kerf': await readFile(file) });
  const opened = await settled(viewer, 'journal', ({ hash }) => hash === before.hash);
  await viewer.page.getByText('Verified up to step', { exact: false }).waitFor();
  await viewer.page.keyboard.press('c');
  await isJoined(viewer);
  return carvedMore(viewer, opened, y);
}

/** Lets a dialog of the browser be answered, and says what it was. */
async function answerOf(page, accepts, act) {
  const [dialog] = await Promise.all([page.waitForEvent('dialog'), act()]);
  const asked = { type: dialog.type(), text: dialog.message() };
  if (accepts) await dialog.accept();
  else await dialog.dismiss();
  return asked;
}

/** The page asks about unsaved strokes, which come back when the page is loaded again. */
async function checkKept(viewer, address, before) {
  const { page } = viewer;
  const last = await carvedMore(viewer, before, 0.35);
  const other = () => dropFiles(page, { 'other.ngc': OTHER });
  const { type, text } = await answerOf(page, false, other);
  assert.equal(type, 'confirm');
  assert.match(text, /^Unsaved strokes/);
  assert.equal((await viewer.state()).hash, last.hash, 'the strokes were lost');
  const closing = await answerOf(page, false, () => page.close({ runBeforeUnload: true }));
  assert.equal(closing.type, 'beforeunload');
  await until('strokes that the browser keeps', SETTLE_S, () => keepsState(page, last));
  page.once('dialog', (dialog) => void dialog.accept());
  await page.goto(address);
  await settled(viewer, 'strokes of before', ({ hash }) => hash === last.hash);
  await photograph(viewer, join(options.out, 'hand-kept.png'));
  // The press ends when the question is answered.
  const newBlock = () => void page.getByRole('button', { name: 'New block', exact: true }).click();
  await answerOf(page, false, newBlock);
  assert.equal((await viewer.state()).hash, last.hash, 'the strokes were lost');
  await answerOf(page, true, newBlock);
  await until('strokes to be discarded', SETTLE_S, async () => !(await keptBytes(page)));
  await settled(viewer, 'new block', ({ removedMm3 }) => removedMm3 === 0);
  await page.reload();
  await settled(viewer, 'block of the page', ({ removedMm3 }) => removedMm3 === 0);
  assert.equal(await keptBytes(page), null);
}

/** The file of strokes in the browser's storage; null if it has none. */
function keptBytes(page) {
  return page.evaluate(
    () =>
      new Promise((resolve, reject) => {
        const opening = indexedDB.open('kerf', 1);
        opening.onerror = () => reject(opening.error);
        opening.onsuccess = () => {
          const request = opening.result
            .transaction('autosave')
            .objectStore('autosave')
            .get('last');
          request.onsuccess = () => {
            opening.result.close();
            resolve(request.result ? [...request.result.bytes] : null);
          };
        };
      }),
  );
}

/** Whether what the browser keeps leads to a state: while one carves, it is some seconds old. */
async function keepsState(page, { hash }) {
  const bytes = await keptBytes(page);
  if (!bytes) return false;
  const file = join(options.out, 'kept.kerf');
  await writeFile(file, Uint8Array.from(bytes));
  return spawnSync(options.server, ['replay', file], {
    encoding: 'utf8',
  }).stdout.includes(hash);
}

/** A kerf-server has the saved file as a session. */
async function checkServed(file, folder, { hash }) {
  const data = join(folder, 'data');
  await mkdir(data);
  await copyFile(file, join(data, 'by-hand.kerf'));
  const server = start(options.server, ['--listen', '127.0.0.1:0', '--data', data, '--open']);
  try {
    const base = await until('server address', 20, () =>
      server.lines.find((line) => line.startsWith('http')),
    );
    const session = await until('session of the file', SETTLE_S, async () => {
      const answer = await fetch(`${base}/v1/sessions/by-hand`);
      return answer.ok && (await answer.json());
    });
    assert.equal(session.state_hash, hash);
    const { authors } = await (await fetch(`${base}/v1/sessions/by-hand/authors`)).json();
    assert(
      authors.some(({ name }) => name === 'Ada'),
      `no Ada: ${JSON.stringify(authors)}`,
    );
  } finally {
    await stop(server);
  }
}

/** Two files that the page has continued from one merge in both orders to one block. */
function checkMerged(folder, files) {
  const hashes = [files, files.toReversed()].map((pair, n) => {
    const out = join(folder, `both-${n}.kerf`);
    const { stdout, stderr } = spawnSync(options.server, ['merge', ...pair, '-o', out], {
      encoding: 'utf8',
    });
    assert.match(stdout, /stroke \d+ by Ada, .* motions\n/, stderr);
    const [, strokes, hash] = /with (\d+) strokes .* hash ([0-9a-f]{16})/.exec(stdout);
    assert.equal(strokes, '1', stdout);
    return hash;
  });
  assert.equal(hashes[0], hashes[1]);
}

async function test(folder) {
  const host = await serveFiles(options.web);
  const files = ['first', 'second', 'third'].map((name) => join(folder, `${name}.kerf`));
  await withBrowser(async (browser) => {
    const viewer = await openViewer(browser, `${host.base}/kerf.html`, DESK, {
      reducedMotion: 'reduce',
    });
    const { page } = viewer;
    const untouched = await checkHand(viewer);
    await checkKept(viewer, `${host.base}/kerf.html`, untouched);
    const first = await checkHand(viewer);
    await page.getByRole('button', { name: 'Download', exact: true }).click();
    await page.getByLabel('Your name').fill('Ada');
    await page.keyboard.press('Tab');
    await page.getByRole('button', { name: 'Close' }).click();
    await savedTo(viewer, files[0]);
    checkReplayed(options.server, files[0], first);
    const second = await checkReopened(viewer, files[0], first);
    await viewer.page.setViewportSize(PHONE);
    await photograph(viewer, join(options.out, 'hand-phone.png'));
    await viewer.page.setViewportSize(DESK);
    await savedTo(viewer, files[1]);
    await checkReopened(viewer, files[0], first, 0.4);
    await savedTo(viewer, files[2]);
    assert.deepEqual(viewer.problems, []);
    checkMerged(folder, files.slice(1));
    await checkServed(files[1], folder, second);
  });
}

await runFilesTest(test, options);
