// SPDX-License-Identifier: Apache-2.0
// Compares the page's pictures with exact ones, on ten carved blocks: in three windows, as it comes
// first, at the levels of detail of its distance, and at rest; and the picture of 3840 pixels that is
// saved from the first window as soon as the block is there. See README.md.
//
// node picture_bench.mjs --server PROGRAM --web FOLDER [--only SCENE] [--out FOLDER]

import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { likeness } from './support/likeness.mjs';
import { PICTURE_SCENES } from './support/picture_scenes.mjs';
import { stillShot } from './support/pictures.mjs';
import { until } from './support/processes.mjs';
import { carveProgram, optionsOf, runTest, startEmptyServer } from './support/session.mjs';

const options = optionsOf(['server', 'web'], { only: '', out: '' });

const SETTLE_S = 120;
const WINDOWS = [
  { name: '1440 x 900', viewport: { width: 1440, height: 900 } },
  {
    name: '720 x 450 @2',
    viewport: { width: 720, height: 450 },
    deviceScaleFactor: 2,
  },
  {
    name: '390 x 844 @2',
    viewport: { width: 390, height: 844 },
    deviceScaleFactor: 2,
  },
];
const WANTED = { ssim: 0.99, wrongSkin: 1e-4 };

async function createBlock(base, n, { scene, program }) {
  const id = `block-${n}`;
  const body = JSON.stringify(scene);
  const created = await fetch(`${base}/v1/sessions?id=${id}`, {
    method: 'POST',
    body,
  });
  if (created.status !== 201) throw new Error(`${scene.name}: ${await created.text()}`);
  await carveProgram(`${base}/v1/sessions/${id}`, program, `name=${n}.ngc&pace=fast`);
  return id;
}

async function open(browser, base, id, window, query = '') {
  const { viewport, deviceScaleFactor } = window;
  const address = `${base}/?session=${id}${query}`;
  const viewer = await openViewer(browser, address, viewport, {
    deviceScaleFactor,
  });
  await until('block', SETTLE_S, () => viewer.page.evaluate(() => window.kerf?.marks.block));
  return viewer;
}

const levelsOf = async (viewer) => (await viewer.state()).tiles.map(({ level }) => level);
const isExact = async (viewer) => (await levelsOf(viewer)).every((level) => level === 0);

/** Of the levels of detail that are there, also while the picture has not rested long enough. */
async function firstShot({ page }) {
  await nextFrames(page);
  await page.waitForFunction(() => window.kerf.state().pictures.isStill, null, {
    polling: 200,
  });
  return page.screenshot({ timeout: 120_000 });
}

/** Screenshots of the page without the block, as it comes first, at rest, and of exact tiles. */
async function pictures(browser, base, id, window) {
  const exact = await open(browser, base, id, window, '&embed&quality=full');
  await until('exact tiles', SETTLE_S, () => isExact(exact));
  const truth = await stillShot(exact);
  await exact.page.addStyleTag({ content: 'canvas { visibility: hidden; }' });
  const empty = await exact.page.screenshot({ timeout: 120_000 });
  await exact.page.context().close();
  const viewer = await open(browser, base, id, window, '&embed');
  const coarsest = Math.max(...(await levelsOf(viewer)));
  const first = await firstShot(viewer);
  await until('exact tiles', SETTLE_S, () => isExact(viewer));
  const rest = await stillShot(viewer);
  return { viewer, truth, empty, first, rest, coarsest };
}

async function saved({ page }) {
  const coming = page.waitForEvent('download', { timeout: 120_000 });
  await page.getByRole('button', { name: 'Save picture' }).click();
  return readFile(await (await coming).path());
}

/** The saved pictures of the page as it comes first, of exact tiles, and of the background alone. */
async function savedPictures(browser, base, id) {
  const viewer = await open(browser, base, id, WINDOWS[0]);
  const first = await saved(viewer);
  await viewer.page.context().close();
  const exact = await open(browser, base, id, WINDOWS[0], '&quality=full');
  await until('exact tiles', SETTLE_S, () => isExact(exact));
  const truth = await saved(exact);
  await exact.page.evaluate(() => {
    CanvasRenderingContext2D.prototype.drawImage = () => undefined;
  });
  const empty = await saved(exact);
  await exact.page.context().close();
  return { first, truth, empty };
}

const textOf = ({ ssim, wrongSkin }) => `${ssim.toFixed(4)}  ${(100 * wrongSkin).toFixed(4)} %`;

async function keep(id, name, shots) {
  if (!options.out) return;
  for (const [kind, png] of Object.entries(shots))
    await writeFile(join(options.out, `${id}-${name.replaceAll(' ', '')}-${kind}.png`), png);
}

async function measureSaved(browser, base, id, name) {
  const { first, truth, empty } = await savedPictures(browser, base, id);
  const page = await browser.newPage();
  const found = await likeness(page, first, truth, empty);
  await page.close();
  console.log(`${name.padEnd(16)} ${'saved'.padEnd(13)} ${textOf(found)}`);
  await keep(id, 'saved', { first, truth });
  return { saved: found };
}

async function measure(browser, base, id, name, window) {
  const { viewer, truth, empty, first, rest, coarsest } = await pictures(browser, base, id, window);
  const atFirst = await likeness(viewer.page, first, truth, empty);
  const atRest = await likeness(viewer.page, rest, truth, empty);
  await viewer.page.context().close();
  console.log(
    `${name.padEnd(16)} ${window.name.padEnd(13)} level ${coarsest}: ${textOf(atFirst)}` +
      `   at rest: ${textOf(atRest)}`,
  );
  await keep(id, window.name, { first, rest, truth });
  return { atFirst, atRest };
}

await runTest(async (folder) => {
  const { base } = await startEmptyServer(options, folder);
  const all = [];
  await withBrowser(async (browser) => {
    console.log('scene            window        as it comes first: SSIM, wrong skin; at rest');
    for (const [n, block] of PICTURE_SCENES.entries()) {
      if (options.only && block.name !== options.only) continue;
      const id = await createBlock(base, n, block);
      for (const window of WINDOWS) all.push(await measure(browser, base, id, block.name, window));
      all.push(await measureSaved(browser, base, id, block.name));
    }
  });
  for (const kind of ['atFirst', 'atRest', 'saved']) {
    const found = all.flatMap((each) => each[kind] ?? []);
    const ssim = Math.min(...found.map((each) => each.ssim));
    const wrongSkin = Math.max(...found.map((each) => each.wrongSkin));
    const holds = found.filter(
      (each) => each.ssim >= WANTED.ssim && each.wrongSkin <= WANTED.wrongSkin,
    ).length;
    console.log(
      `${kind}: worst SSIM ${ssim.toFixed(4)}, worst skin ${(100 * wrongSkin).toFixed(4)} %; ` +
        `${holds} of ${found.length} have 0.99 and 0.01 %`,
    );
  }
}, options.out);
