// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the page in Firefox, as on a desk and as on a phone: it draws the server's
// surface, carves it with a mouse and with a finger, and inspects it. See README.md.
//
// node firefox_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { placeOf, restingBlock } from './support/block.mjs';
import { fingerRests } from './support/finger.mjs';
import { openInFirefox, withFirefox } from './support/firefox.mjs';
import { intersecting } from './support/layout.mjs';
import { stillShot } from './support/pictures.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { carveProgram, getJson, optionsOf, runTest, startServer } from './support/session.mjs';
import { assertSameSurface, sectionArea, stlCorners } from './support/surface.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 90; // software WebGL on a busy machine
const SCENE = boxScene('In Firefox', [-20, -15, -10], [20, 15, 0], [cutter(1, 'ball', 6)], {
  machine: { kinematics: 'tool-vector' },
});
const PROGRAM = `G21 G90
T1 M6
S10000 M3
G0 X-14 Y8 Z5
G1 Z-4 F900
G1 X14
G0 Z5
M30
`;
const PLACE_MM = 15.3; // of a section, beside the grooves' ends
const DESK = { width: 1280, height: 800 };
const PHONE = {
  width: 390,
  height: 844,
  deviceScaleFactor: 2,
  hasTouch: true,
  isMobile: false,
};
const BOXES = ['.bar', '.toolbar', '.panel'];
const SAME_MM = 0.003; // tiles have vertices of 16 bits

async function stlOf(session) {
  const response = await fetch(`${session}/model.stl`);
  return Buffer.from(await response.arrayBuffer());
}

/** Waits until the whole block is drawn and no box lies on another, with the block inside the page. */
async function untilDrawn({ page, state }, boxes, { width, height }) {
  await until('picture', SETTLE_S, async () => {
    const marks = await page.evaluate(() => window.kerf?.marks);
    return marks?.picture && (await state()).snapshotComplete;
  });
  await until(`free block at ${width} × ${height}`, SETTLE_S, async () => {
    const { blockBox } = await state();
    const [left, top, right, bottom] = blockBox;
    const isInside = left >= 0 && top >= 0 && right <= width && bottom <= height;
    return isInside && (await intersecting(page, boxes, [blockBox])).length === 0;
  });
}

/** The canvas shows something: colors of the picture at its places differ. */
async function checkNotBlank(viewer, file) {
  const { page, state } = viewer;
  const png = await stillShot(viewer);
  await writeFile(file, png);
  const box = (await state()).blockBox;
  const deviation = await page.evaluate(
    async ([data, [left, top, right, bottom]]) => {
      const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
      const scale = bitmap.width / innerWidth;
      const [x, y, wide, high] = [left, top, right - left, bottom - top].map((value) =>
        Math.round(value * scale),
      );
      const context = new OffscreenCanvas(wide, high).getContext('2d');
      context.drawImage(bitmap, -x, -y);
      const { data: rgba } = context.getImageData(0, 0, wide, high);
      const values = [];
      for (let n = 0; n < rgba.length; n += 4) values.push(rgba[n] + rgba[n + 1] + rgba[n + 2]);
      const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
      return Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length);
    },
    [png.toString('base64'), box],
  );
  assert(deviation > 10, `the picture is blank: ${deviation}`);
}

async function checkSurface({ page }, session, what) {
  const corners = await until(`the surface ${what}`, SETTLE_S, async () => {
    const shown = await page.evaluate(() => Array.from(window.kerf.surface()));
    assertSameSurface(shown, await stlOf(session), SCENE.stock, SAME_MM);
    return shown;
  });
  console.log(`${what}: ${corners.length / 9} triangles, as the server's`);
}

async function dragMouse(viewer) {
  const { mouse } = viewer.page;
  await mouse.move(...(await placeOf(viewer, 0.3, 0.6)));
  await mouse.down();
  await mouse.move(...(await placeOf(viewer, 0.5, 0.65)), { steps: 6 });
  await mouse.move(...(await placeOf(viewer, 0.65, 0.65)), { steps: 6 });
  await mouse.up();
}

async function dragFinger(viewer) {
  const { touchscreen } = viewer.page;
  const finger = await touchscreen.touchStart(...(await placeOf(viewer, 0.35, 0.45)));
  await fingerRests();
  for (let n = 1; n <= 10; n += 1)
    await finger.move(...(await placeOf(viewer, 0.35 + 0.03 * n, 0.45)));
  await finger.end();
}

/** The server's block, once a probe of it holds and the page's copy is equal to it. */
function settled(viewer, session, what, isDone) {
  return restingBlock(viewer, () => getJson(session), what, SETTLE_S, isDone);
}

/** Carves a stroke, undoes and redoes it. */
async function checkCarving(viewer, session, drag) {
  const { page } = viewer;
  const before = await getJson(session);
  await page.locator('button[aria-label^="Carve"]').click();
  await page.waitForSelector('main[data-carve=ready]');
  const isBefore = ({ state_hash: hash }) => hash === before.state_hash;
  await page.mouse.move(...(await placeOf(viewer, 0.4, 0.5))); // stock comes to where a tool is
  await settled(viewer, session, 'stock of the server in the page', isBefore);
  await drag(viewer);
  const cut = await settled(
    viewer,
    session,
    'a cut',
    (block) => block.removed_volume_mm3 > before.removed_volume_mm3 + 10,
  );
  await page.keyboard.down('Control');
  await page.keyboard.press('z');
  await page.keyboard.up('Control');
  await settled(viewer, session, 'undo', isBefore);
  await page.keyboard.down('Control');
  await page.keyboard.press('y');
  await page.keyboard.up('Control');
  await settled(viewer, session, 'redo', (block) => block.state_hash === cut.state_hash);
  await page.keyboard.press('Escape');
  await page.waitForSelector('main[data-carve=off]');
}

/** The area of a section is that of the server's model. */
async function checkSection({ page }, session) {
  await page.locator('button[aria-label="Sections and measurements"]').click();
  await page.locator('button[aria-label="Section across X"]').click();
  const field = await page.waitForSelector('.inspect-number');
  await field.click({ count: 3 });
  await page.keyboard.type(String(PLACE_MM));
  await page.keyboard.press('Enter');
  const expected = sectionArea(stlCorners(await stlOf(session)), [1, 0, 0], PLACE_MM);
  await until('the area of the section', SETTLE_S, async () => {
    const text = await page.$eval('.inspect-figures', (element) => element.textContent);
    const place = await field.evaluate((input) => input.value);
    const area = Number(/Area ([\d,.]+)/.exec(text)[1].replace(',', ''));
    const isRight = Number(place) === PLACE_MM && Math.abs(area / expected - 1) < 1e-3;
    if (!isRight) throw new Error(`${area} mm² at ${place}, instead of ${expected} mm²`);
    return true;
  });
}

async function checkAs(browser, { base, session }, name, viewport, drag) {
  const address = `${base}/?session=fox&quality=full&name=${name}`;
  const viewer = await openInFirefox(browser, address, viewport);
  await untilDrawn(viewer, BOXES, viewport);
  await checkNotBlank(viewer, join(options.out, `firefox-${viewport.width}.png`));
  await checkSurface(viewer, session, `${name} joins`);
  await checkCarving(viewer, session, drag);
  await checkSurface(viewer, session, `${name} has carved`);
  await checkSection(viewer, session);
  await untilDrawn(viewer, [...BOXES, '.inspect'], viewport);
  await viewer.page.screenshot({
    path: join(options.out, `firefox-section-${viewport.width}.png`),
  });
  assert.deepEqual(viewer.problems, []);
  await viewer.close();
}

async function test(folder) {
  const { server, ...place } = await startServer(options, folder, 'fox', SCENE);
  await carveProgram(place.session, PROGRAM, 'name=groove.ngc&pace=fast');
  await withFirefox(async (browser) => {
    console.log(await browser.version());
    await checkAs(browser, place, 'Desk', DESK, dragMouse);
    await checkAs(browser, place, 'Phone', PHONE, dragFinger);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
