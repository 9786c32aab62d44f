// SPDX-License-Identifier: Apache-2.0
// End-to-end test of kerf.html, served as plain files: a dropped program is carved in the page, its
// state hash and STL file are those of kerf-carve, a hand carves on, to the hash of kerf-server, and
// errors are shown at their place. See README.md.
//
// node local_live.mjs --server PROGRAM --carve PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { photograph } from './support/pictures.mjs';
import { dropFiles } from './support/drop.mjs';
import { serveFiles } from './support/file_host.mjs';
import {
  carvedMore,
  checkReplayed,
  downloadOf,
  isJoined,
  savedTo,
  settled,
} from './support/local_page.mjs';
import { until } from './support/processes.mjs';
import { optionsOf, runFilesTest } from './support/session.mjs';
import { clashesIn } from './support/texts.mjs';

const options = optionsOf(['server', 'carve', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const DESK = { width: 1440, height: 900 };
const PHONE = { width: 390, height: 844 };
const NAME = 'wave.ngc';
const PROGRAM = [
  '(T5 D=6. CR=3. - ball end mill)',
  ...['G21 G90', 'T5 M6', 'S10000 M3', 'F800', 'G0 X0 Y0 Z5', 'G1 Z-1'],
  ...Array.from({ length: 16 }, (_, row) =>
    Array.from({ length: 21 }, (__, n) => {
      const x = row % 2 === 0 ? 2 * n : 40 - 2 * n;
      return `G1 X${x} Y${(1.6 * row).toFixed(2)} Z${(-2 + Math.sin(x / 4 + row / 3)).toFixed(4)}`;
    }),
  ).flat(),
  ...['G0 Z5', 'M30', ''],
].join('\n');
const CUTS = 16 * 21; // of the program
const SCENE = JSON.stringify({
  name: 'wave',
  stock: { shape: 'box', min_mm: [-3, -3, -6], max_mm: [43, 27, 0] },
  accuracy: { pitch_mm: 0.4, tolerance_mm: 0.02 },
  tools: [{ id: 5, shape: 'ball', diameter_mm: 6, length_mm: 30 }],
});
const FAULT = 'G21 G90\nG1 X5 F100\nG1 X7 Q3\nM30\n';

async function carvedHere(folder) {
  await writeFile(join(folder, NAME), PROGRAM);
  await writeFile(join(folder, 'wave.json'), SCENE);
  const args = ['--program', NAME, '--scene', 'wave.json', '--stl', 'here.stl'];
  args.push('--report', 'here.json');
  const { status, stderr } = spawnSync(options.carve, args, {
    cwd: folder,
    encoding: 'utf8',
  });
  assert.equal(status, 0, stderr);
  const report = JSON.parse(await readFile(join(folder, 'here.json'), 'utf8'));
  return { ...report, stl: await readFile(join(folder, 'here.stl')) };
}

async function checkCarving(viewer, here) {
  const { page } = viewer;
  await checkAccessible(page, 'the page as it opens');
  await dropFiles(page, { [NAME]: PROGRAM, 'wave.json': SCENE });
  const { hash } = await settled(viewer, 'program', ({ carved, motions }) => {
    return motions >= CUTS && carved === motions; // the block with which the page opens has few
  });
  assert.equal(hash, here.state_hash);
  await page.getByText(here.state_hash).waitFor({ state: 'attached' }); // under Details
  const stl = await readFile(await takenHome(page, 'stl'));
  assert(stl.equals(here.stl), "the page's STL file is not that of kerf-carve");
  await checkThreemf(await takenHome(page, '3mf'), stl);
}

/** The path of the file that a button gives. */
async function takenHome(page, format) {
  const download = await downloadOf(page, format.toUpperCase());
  assert.equal(download.suggestedFilename(), `wave.${format}`);
  return download.path();
}

/** Python reads the archive; it has the triangles of the STL file, and is compressed. */
async function checkThreemf(path, stl) {
  const script = [
    'import re, sys, zipfile',
    'zip = zipfile.ZipFile(sys.argv[1])',
    'assert zip.testzip() is None',
    'print(len(re.findall(rb"<triangle ", zip.read("3D/3dmodel.model"))))',
  ].join('\n');
  const { stdout, stderr } = spawnSync('python3', ['-c', script, path], {
    encoding: 'utf8',
  });
  assert.equal(stderr, '');
  assert.equal(Number(stdout), (stl.length - 84) / 50, 'the 3MF file has other triangles');
  const { length } = await readFile(path);
  assert(3 * length < stl.length, `a 3MF file of ${length} bytes for an STL of ${stl.length}`);
}

/** The scrub bar goes back: another state, and at the end the same again. */
async function checkScrubbing(viewer, here) {
  const { page, state } = viewer;
  const scrub = page.getByRole('slider', { name: 'Position in the program' });
  await scrub.fill('100');
  const then = await settled(viewer, 'state of motion 100', ({ carved }) => carved === 100);
  assert.notEqual(then.hash, here.state_hash);
  await page.getByText('Step 100 of', { exact: false }).waitFor();
  const spread = await photograph(viewer, join(options.out, 'local-scrubbed.png'));
  assert(spread > 4, `the picture is blank: ${spread}`);
  await scrub.fill(String((await state()).motions));
  return settled(viewer, 'state of the end', ({ hash }) => hash === here.state_hash);
}

/** A hand carves behind the program, which is one stroke of the journal; undoes and redoes. */
async function checkHand(viewer, carved, file) {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Carve', exact: true }).click();
  await isJoined(viewer);
  await settled(viewer, 'program in the journal', ({ hash }) => hash === carved.hash);
  const last = await carvedMore(viewer, carved, 0.5);
  await page.keyboard.press('Control+z');
  await settled(viewer, 'undo', ({ hash }) => hash === carved.hash);
  await page.keyboard.press('Control+Shift+z');
  await settled(viewer, 'redo', ({ hash }) => hash === last.hash);
  await checkAccessible(page, 'the page while a hand carves');
  for (const size of [PHONE, DESK]) {
    await page.setViewportSize(size);
    await nextFrames(page);
    assert.deepEqual(
      await clashesIn(page, 'main > :is(.bar, .main-actions, .toolbar, .panel, .carve-bar)'),
      [],
    );
    await photograph(viewer, join(options.out, `local-hand-${size.width}.png`));
  }
  await savedTo(viewer, file);
  checkReplayed(options.server, file, last);
}

async function checkFault({ page, state }) {
  await dropFiles(page, { 'fault.ngc': FAULT });
  await until('rejected program', SETTLE_S, async () => (await state()).status === 'failed');
  await page
    .getByRole('alert')
    .getByText("fault.ngc:3: 'Q3' is not used", { exact: false })
    .waitFor();
  assert.equal(await page.locator('.program-row.marked mark').textContent(), 'Q3');
}

/** Opens the page offline, from the browser's cache, and carves by hand. */
async function checkOffline(browser, host) {
  const viewer = await openViewer(browser, `${host.base}/kerf.html`, DESK);
  const { page } = viewer;
  const isKept = async () => {
    await navigator.serviceWorker.ready;
    return (await caches.match('./kerf.html')) !== undefined;
  };
  await until('files that the browser keeps', SETTLE_S, () => page.evaluate(isKept));
  await page.context().setOffline(true);
  await page.reload();
  await isJoined(viewer);
  const first = await settled(viewer, 'block without a network', () => true);
  await carvedMore(viewer, first, 0.5);
  assert.deepEqual(viewer.problems, []);
  await page.context().close();
}

async function test(folder) {
  const here = await carvedHere(folder);
  const host = await serveFiles(options.web);
  await withBrowser(async (browser) => {
    const viewer = await openViewer(browser, `${host.base}/kerf.html`, DESK, {
      reducedMotion: 'reduce',
    });
    await isJoined(viewer); // the block with which the page opens
    await photograph(viewer, join(options.out, 'local-first.png'));
    await checkCarving(viewer, here);
    await until('picture', SETTLE_S, async () => (await viewer.state()).hasPicture);
    await photograph(viewer, join(options.out, 'local.png'));
    await checkAccessible(viewer.page, 'the page with a block');
    const carved = await checkScrubbing(viewer, here);
    await checkHand(viewer, carved, join(folder, 'by-hand.kerf'));
    await checkFault(viewer);
    assert.deepEqual(viewer.problems, []);
    await checkOffline(browser, host);
    assert.deepEqual(host.missing, [], 'the page asks for what is not in its folder');
  });
}

await runFilesTest(test, options);
