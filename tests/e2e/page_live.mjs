// SPDX-License-Identifier: Apache-2.0
// End-to-end test of behavior that only a browser shows: it connects before it touches the GPU,
// loads little, covers the block with nothing at any size, has no side in the dark, and works
// without WebGL. See README.md.
//
// node page_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { openViewer, withBrowser } from './support/browser.mjs';
import { differenceOf, luminanceIn, stillShot, untilStill } from './support/pictures.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { optionsOf, runTest, startServer } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 90; // software WebGL on a busy machine
const FIRST_LOAD_BYTES = 280_000; // on the wire, with the font
const FIRST_LOAD_GZIP_BYTES = 230_000; // without it
const SCENE = boxScene('Bracket op 1', [-30, -20, -20], [30, 20, 0], [cutter(1, 'ball', 6)], {
  accuracy: { pitch_mm: 0.1 },
});
const SIZES = [
  [320, 640],
  [390, 844],
  [844, 390],
  [768, 1024],
  [1440, 900],
  [2560, 1440],
];
const SIDES = ['1', 'Shift+1', '3', 'Shift+3', '7', 'Shift+7'];

/** Opens the page and counts the bytes of its files on the wire. */
async function openCounted(browser, url) {
  const viewer = await openViewer(browser, 'about:blank', {
    width: 1440,
    height: 900,
  });
  const network = await viewer.page.context().newCDPSession(viewer.page);
  await network.send('Network.enable');
  viewer.bytes = 0;
  const files = [];
  const pictures = new Set(); // of the block, which the page asks for where its own is late
  network.on('Network.responseReceived', ({ requestId, response }) => {
    const { pathname } = new URL(response.url);
    files.push(pathname);
    if (pathname.endsWith('/picture.png')) pictures.add(requestId);
  });
  network.on('Network.loadingFinished', ({ requestId, encodedDataLength }) => {
    if (!pictures.has(requestId)) viewer.bytes += encodedDataLength;
  });
  await viewer.page.goto(url);
  await untilWhole(viewer);
  viewer.gzipBytes = await gzipBytesOf(files);
  return viewer;
}

/** Bytes of the page's files, without the font, as gzip would compress them. */
async function gzipBytesOf(paths) {
  const served = paths.filter(
    (path) => path.startsWith('/') && !path.startsWith('/v1/') && !path.endsWith('.woff2'),
  );
  const files = [...new Set(served)].map((path) => (path === '/' ? 'index.html' : path));
  const sizes = files.map(async (file) => gzipSync(await readFile(join(options.web, file))).length);
  return (await Promise.all(sizes)).reduce((sum, size) => sum + size, 0);
}

/** Waits until all of the block is drawn. */
async function untilWhole({ page, state }) {
  await until('picture', SETTLE_S, async () => {
    const marks = await page.evaluate(() => window.kerf?.marks);
    return marks?.picture && (await state()).snapshotComplete;
  });
}

function checkStart(viewer, marks) {
  assert(marks.hello < marks.view, `the GPU came before the connection: ${JSON.stringify(marks)}`);
  assert(viewer.bytes > 100_000 && viewer.bytes <= FIRST_LOAD_BYTES, `${viewer.bytes} bytes`);
  const gzip = viewer.gzipBytes;
  assert(gzip > 100_000 && gzip <= FIRST_LOAD_GZIP_BYTES, `${gzip} bytes by gzip`);
  console.log(
    `hello after ${marks.hello.toFixed(0)} ms, picture after ${marks.picture.toFixed(0)} ms, ` +
      `${viewer.bytes} bytes of files, by gzip without the font ${gzip}`,
  );
}

/** Equal tiles come in few bytes. */
function checkUntouched({ tiles, meshBytes }) {
  assert(tiles.length > 200, `${tiles.length} tiles`);
  assert(meshBytes < 250 * tiles.length, `${meshBytes} bytes for ${tiles.length} tiles`);
  console.log(`${tiles.length} untouched tiles: ${meshBytes} bytes`);
}

/** Equal tiles are drawn in few calls, in a frame that does not draw the shadows again. */
async function checkCalls({ page, state }) {
  await page.locator('.canvas').focus();
  await page.keyboard.press('f');
  await page.keyboard.press('ArrowLeft'); // only the camera moves
  const few = await until('few draw calls', SETTLE_S, async () => {
    const { tiles, drawCalls } = await state();
    return drawCalls < tiles.length / 4 && { tiles, drawCalls };
  });
  console.log(`${few.tiles.length} untouched tiles: ${few.drawCalls} draw calls`);
}

/** At every size, block, bar, toolbar and panel have boxes that do not intersect. */
async function checkLayouts({ page, state }) {
  for (const [width, height] of SIZES) {
    await page.setViewportSize({ width, height });
    await until(`free block at ${width} × ${height}`, SETTLE_S, async () => {
      const all = await page.evaluate(() =>
        ['.bar', '.toolbar', '.panel'].map((selector) => {
          const { left, top, right, bottom } = document
            .querySelector(selector)
            .getBoundingClientRect();
          return [left, top, right, bottom];
        }),
      );
      const block = (await state()).blockBox;
      all.push(block);
      const [left, top, right, bottom] = block;
      const isInside = left >= 0 && top >= 0 && right <= width && bottom <= height;
      const share = Math.max((right - left) / width, (bottom - top) / height);
      const isFree = all.every((box, n) =>
        all.slice(0, n).every((other) => !intersect(box, other)),
      );
      return isFree && isInside && share > 0.3;
    });
  }
}

function intersect(a, b) {
  return a[0] < b[2] - 1 && b[0] < a[2] - 1 && a[1] < b[3] - 1 && b[1] < a[3] - 1;
}

/** No side of the block is twice as bright as another. */
async function checkSides(viewer) {
  const { page, state } = viewer;
  await page.setViewportSize({ width: 640, height: 480 });
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await page.reload();
  await untilWhole(viewer);
  await page.locator('.canvas').focus();
  const luminances = [];
  for (const side of SIDES) {
    await page.keyboard.press(side);
    await untilStill(viewer);
    luminances.push(await luminanceIn(viewer, (await state()).blockBox));
  }
  const text = luminances.map((value) => value.toFixed(3)).join(', ');
  console.log(`luminance of front, back, right, left, top, bottom: ${text}`);
  assert(Math.max(...luminances) <= 2 * Math.min(...luminances), text);
}

/** The pixels read back from WebGL equal those on the page's canvas, but for edges. */
async function checkReadback(browser, base) {
  const [read, drawn] = await Promise.all(
    ['', '&quality=full'].map(async (quality) => {
      const address = `${base}/?session=page&name=Alan${quality}`;
      const viewer = await openViewer(browser, address, {
        width: 640,
        height: 480,
      });
      await untilStill(viewer);
      return viewer;
    }),
  );
  const is2d = await Promise.all(
    [read, drawn].map(({ page }) =>
      page.locator('.canvas').evaluate((canvas) => canvas.getContext('2d') !== null),
    ),
  );
  assert.deepEqual(is2d, [true, false]);
  const box = (await read.state()).blockBox;
  const difference = await differenceOf(read, drawn, box);
  console.log(`read back and drawn differ by ${difference.toFixed(2)} of 255`);
  assert(difference < 2, `${difference}`);
  for (const { page } of [read, drawn]) await page.context().close();
}

/** While the page's own picture is late, the server's stands where the block will be. */
async function checkPoster(browser, base) {
  const viewer = await openViewer(browser, 'about:blank', { width: 1200, height: 800 });
  const { page } = viewer;
  let go = () => {};
  const held = new Promise((resolve) => (go = resolve));
  await page.route(/\/assets\/viewer-[^/]*\.js$/, async (route) => {
    await held;
    await route.continue();
  });
  await page.goto(`${base}/?session=page&name=Edsger`);
  const poster = page.locator('.poster.placed');
  await until('picture by the server', SETTLE_S, () =>
    poster.evaluateAll((found) => found.some((image) => image.complete && image.naturalWidth > 0)),
  );
  await writeFile(join(options.out, 'page-poster.png'), await page.screenshot());
  go();
  await untilWhole(viewer);
  await poster.waitFor({ state: 'hidden', timeout: 1000 * SETTLE_S });
  await page.context().close();
}

/** People, figures and downloads are there where WebGL is not. */
async function checkWithoutWebGl(base, scratch) {
  const withoutWebGl = ['--disable-gpu', '--disable-3d-apis'];
  await withBrowser(async (browser) => {
    const viewer = await openViewer(browser, `${base}/?session=page&name=Mary`, {
      width: 800,
      height: 600,
    });
    const { page, state } = viewer;
    await until('session without a picture', SETTLE_S, async () => (await state())?.settled);
    assert.equal((await state()).hasPicture, false);
    await page.getByText('No 3D view').waitFor();
    await page.getByText('Mary (you)').waitFor();
    await page.getByRole('heading', { name: SCENE.name }).waitFor();
    const poster = page.locator('.poster');
    await until('picture by the server', SETTLE_S, () =>
      poster.evaluate((image) => image.complete && image.naturalWidth > 0),
    );
    await writeFile(join(options.out, 'page-without-webgl.png'), await page.screenshot());
    await page.getByRole('button', { name: 'Download', exact: true }).click();
    const dialog = page.getByRole('dialog', { name: 'Download' });
    await dialog.locator('[value="STL"]').check();
    const started = page.waitForEvent('download');
    await dialog.getByRole('button', { name: 'Download' }).click();
    await (await started).saveAs(join(scratch, 'block.stl'));
  }, withoutWebGl);
}

async function test(folder) {
  const { server, base } = await startServer(options, folder, 'page', SCENE);
  await withBrowser(async (browser) => {
    const viewer = await openCounted(browser, `${base}/?session=page&name=Grace`);
    const { page, problems } = viewer;
    checkStart(viewer, await page.evaluate(() => window.kerf.marks));
    checkUntouched(await viewer.state());
    assert.equal(await page.title(), `${SCENE.name} · Kerf`);
    await writeFile(join(options.out, 'page.png'), await stillShot(viewer));
    await checkLayouts(viewer);
    await checkSides(viewer);
    await checkCalls(viewer);
    await checkReadback(browser, base);
    await checkPoster(browser, base);
    await page.goto(`${base}/?list`);
    await page.getByText('Choose a block to open').waitFor(); // although there is only one
    assert.deepEqual(problems, []);
  });
  await checkWithoutWebGl(base, folder);
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
