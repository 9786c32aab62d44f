// SPDX-License-Identifier: Apache-2.0
// Compares the page's pictures with exact ones, on ten carved blocks and in three windows: as
// it comes first, at the levels of detail of its distance; at rest; and as a saved picture. See
// README.md.
//
// node picture_bench.mjs --server PROGRAM --web FOLDER [--only SCENE] [--out FOLDER]

import { writeFile } from 'node:fs/promises';
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

/** Opens the picture of a block without what lies over it. */
async function open(browser, base, id, window, query = '') {
  const { viewport, deviceScaleFactor } = window;
  const address = `${base}/?session=${id}&embed${query}`;
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
  const exact = await open(browser, base, id, window, '&quality=full');
  await until('exact tiles', SETTLE_S, () => isExact(exact));
  const truth = await stillShot(exact);
  await exact.page.addStyleTag({ content: 'canvas { visibility: hidden; }' });
  const empty = await exact.page.screenshot({ timeout: 120_000 });
  await exact.page.context().close();
  const viewer = await open(browser, base, id, window);
  const coarsest = Math.max(...(await levelsOf(viewer)));
  const first = await firstShot(viewer);
  await until('exact tiles', SETTLE_S, () => isExact(viewer));
  const rest = await stillShot(viewer);
  return { viewer, truth, empty, first, rest, coarsest };
}

async function measure(browser, base, id, name, window) {
  const { viewer, truth, empty, first, rest, coarsest } = await pictures(browser, base, id, window);
  const atFirst = await likeness(viewer.page, first, truth, empty);
  const atRest = await likeness(viewer.page, rest, truth, empty);
  await viewer.page.context().close();
  const text = ({ ssim, wrongSkin }) => `${ssim.toFixed(4)}  ${(100 * wrongSkin).toFixed(4)} %`;
  console.log(
    `${name.padEnd(16)} ${window.name.padEnd(13)} level ${coarsest}: ${text(atFirst)}` +
      `   at rest: ${text(atRest)}`,
  );
  if (options.out) {
    const file = (kind) =>
      join(options.out, `${id}-${window.name.replaceAll(' ', '')}-${kind}.png`);
    for (const [kind, png] of Object.entries({ first, rest, truth }))
      await writeFile(file(kind), png);
  }
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
    }
  });
  for (const kind of ['atFirst', 'atRest']) {
    const ssim = Math.min(...all.map((each) => each[kind].ssim));
    const wrongSkin = Math.max(...all.map((each) => each[kind].wrongSkin));
    const holds = all.filter(
      (each) => each[kind].ssim >= WANTED.ssim && each[kind].wrongSkin <= WANTED.wrongSkin,
    ).length;
    console.log(
      `${kind}: worst SSIM ${ssim.toFixed(4)}, worst skin ${(100 * wrongSkin).toFixed(4)} %; ` +
        `${holds} of ${all.length} have 0.99 and 0.01 %`,
    );
  }
}, options.out);
