// SPDX-License-Identifier: Apache-2.0
// End-to-end test of sections, measures and paths: areas are those of the server's model cut by the
// same plane and those of the drawn caps, a wall is as thick as it was carved, who cut what and how far
// it deviates is said, and lines of a program have their places in the picture. See README.md.
//
// node inspect_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { countPixels } from './support/pictures.mjs';
import { checkFreeBlock } from './support/layout.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { carveProgram, getJson, optionsOf, runTest, startServer } from './support/session.mjs';
import { sectionArea, stlCorners } from './support/surface.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const SIZES = [
  [844, 390],
  [390, 844],
  [640, 480],
];
const SCENE = boxScene('Wall', [-12, -10, -8], [12, 10, 0], [cutter(1, 'flat', 4)], {
  accuracy: { rays: 'tri-dexel' },
});
/** Two grooves, between which a wall of 3 mm stays (y from -4 to -1), and a round hole. */
const PROGRAM = `G21 G90
T1 M6
S10000 M3
G0 X-8 Y-6 Z5
G1 Z-5 F900
G1 X8
G0 Z5
G0 X-8 Y1
G1 Z-5
G1 X8
G0 Z5
G0 X0 Y6.5
G1 Z-6
G0 Z5
M30
`;
const GROOVE_CM3_PER_MIN = (4 * 5 * 900) / 1000;
/** A point next to the plots of a program, CSS pixels. */
const PLOT_LEFT = 44;
const PLOT_RIGHT = 12;
const WALL_MM = 3;
/** Tiles have vertices of 16 bits. */
const QUANTUM_MM = 0.001;

/** The area that the panel shows for a plane, once it is of the exact surface. */
async function areaAt(page, direction, place) {
  await page.getByRole('button', { name: direction }).click();
  const field = page.getByRole('spinbutton', { name: 'Section position' });
  await field.fill(String(place));
  await field.press('Enter');
  return until('area', SETTLE_S, async () => {
    const text = await page.locator('.inspect-figures').first().textContent();
    const shown = Number(await field.inputValue()) === place;
    const area = /Area ([\d,.]+)/.exec(text);
    return shown && area && Number(area[1].replace(',', ''));
  });
}

async function checkAreas(page, corners) {
  for (const [direction, normal, place] of [
    ['Section across X', [1, 0, 0], 0.3],
    ['Section across Y', [0, 1, 0], 6.1],
    ['Section across Z', [0, 0, 1], -2],
  ]) {
    const area = await areaAt(page, direction, place);
    const expected = sectionArea(corners, normal, place);
    console.log(`${direction} at ${place}: ${area} mm², of the STL ${expected.toFixed(2)} mm²`);
    assert(Math.abs(area / expected - 1) < 1e-3, `${area} mm² instead of ${expected} mm²`);
  }
}

/** The block's box in the picture, after what was done last. */
async function blockBox({ page, state }) {
  await nextFrames(page); // motion is reduced, so that views are there at once
  return (await state()).blockBox;
}

/** The pixels of the cap, which is as orange as no blue block is, have its area. */
async function checkCap(viewer) {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Parallel', exact: true }).click();
  const area = await areaAt(page, 'Section across Z', -2);
  await page.getByRole('button', { name: 'Face on' }).click();
  const [left, top, right, bottom] = await blockBox(viewer);
  const box = [left - 2, top - 2, right - left + 4, bottom - top + 4].map(Math.round);
  // The outline, a pixel wide, is up to half outside: 3 % of this cap.
  const drawn = await until('cap of this area', SETTLE_S, async () => {
    const pixels = await countPixels(viewer, box, { leastRedOverBlue: 45 });
    const share = (pixels * (24 / (right - left)) ** 2) / area;
    return share > 0.985 && share < 1.035 && share;
  });
  console.log(`cap: ${drawn.toFixed(4)} of its area drawn`);
}

/** Presses a place of the block, seen from the front in parallel projection, and reads the measure. */
async function measure({ page, state }, name, places) {
  await page.getByRole('button', { name, exact: true }).click();
  const [left, top, right] = await blockBox({ page, state });
  const perMm = (right - left) / 24;
  for (const [x, z] of places) await page.mouse.click(left + (x + 12) * perMm, top - z * perMm);
  const text = await page.getByRole('list', { name: 'Measurements' }).locator('li b').last();
  const value = Number(/[\d.]+/.exec(await text.textContent())[0]);
  console.log(`${name}: ${value}`);
  return value;
}

/** The colors of the curvature take the place of the material's, which is blue where it is original. */
async function checkCurvature(viewer) {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Off', exact: true }).click();
  await page.locator('.canvas').focus();
  await page.keyboard.press('0');
  const [left, top, right, bottom] = await blockBox(viewer);
  const box = [left, top, right - left, bottom - top].map(Math.round);
  const original = async () => {
    const others = await countPixels(viewer, box, { leastRedOverBlue: -25 });
    return box[2] * box[3] - others;
  };
  const before = await original();
  await page.getByRole('button', { name: 'Curvature' }).click();
  await page.getByText('full color up to a radius of').waitFor();
  const after = await original(); // the hole in the middle is hollow, so blue
  assert(after > 0 && after < 0.5 * before, `${after} blue pixels, ${before} before`);
  await page.getByRole('button', { name: 'Curvature' }).click();
  assert.equal(await original(), before);
}

async function checkMeasures(viewer) {
  const { page } = viewer;
  await areaAt(page, 'Section across Y', -6); // through the first groove
  await page.getByRole('button', { name: 'Face on' }).click();
  const wall = await measure(viewer, 'Thickness', [[1.3, -2.2]]);
  assert(Math.abs(wall - WALL_MM) <= QUANTUM_MM, `a wall of ${wall} mm`);
  const depth = await measure(viewer, 'Depth', [[0.4, -5.05]]); // the edge of the groove's ground
  assert(Math.abs(depth - 5) <= 2 * QUANTUM_MM, `a depth of ${depth} mm`);
  const width = await measure(viewer, 'Distance', [
    [-11.9, -0.1],
    [11.9, -0.1],
  ]); // the corners attract
  assert(Math.abs(width - 24) <= 2 * QUANTUM_MM, `a width of ${width} mm`);
  await page.getByRole('button', { name: 'Inches' }).click();
  await page.getByText('0.9449 in').first().waitFor();
}

/** Pressing the ground of the second groove tells its exact place, and the line that cut it. */
async function checkMaker(viewer) {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Off', exact: true }).click();
  await page.locator('.canvas').focus();
  await page.keyboard.press('7');
  await page.getByRole('button', { name: 'Who cut this?' }).click();
  const [left, top, right] = await blockBox(viewer);
  const perMm = (right - left) / 24;
  const press = (x, y) => page.mouse.click(left + (x + 12) * perMm, top + (10 - y) * perMm);
  await press(2.1, 1.1);
  await page.getByText('Cut by wall.ngc in line 10, with tool 1').waitFor();
  const place = await page.locator('.probe-place').textContent();
  const [, x, y, z] = /X (\S+)\s+Y (\S+)\s+Z (\S+) in/.exec(place).map((text) => 25.4 * text);
  assert(Math.hypot(x - 2.1, y - 1.1) < 0.5 && Math.abs(z + 5) < 1e-4, place);
  await press(-11, -9);
  await page.getByText('Original stock surface, not cut yet.').waitFor();
  await page.getByRole('button', { name: 'Who cut this?' }).click();
}

/** The surface that was cut is the program's, and has the color that the legend shows. */
async function checkOwners({ page }) {
  await page.getByRole('button', { name: 'Color by participant' }).click();
  const legend = page.getByRole('list', { name: 'Who cut what' });
  await legend.getByRole('button', { name: /wall\.ngc.*100/ }).waitFor();
  await page.getByRole('button', { name: 'Color by participant' }).click();
}

/** The block deviates by nothing from its own model. */
async function checkDeviation({ page }, buffer) {
  const file = { name: 'part.stl', mimeType: 'model/stl', buffer };
  await page.locator('.deviation input[type=file]').setInputFiles(file);
  await page.locator('.deviation').getByText('100 % within tolerance').waitFor();
}

/** A line that is pressed in the text is marked where it was carved, and a pressed path in the text. */
async function checkPath(viewer) {
  const { page } = viewer;
  await page.getByRole('button', { name: 'NC programs' }).click();
  await page.locator('.programs').waitFor(); // a chunk of its own
  assert.equal(await page.locator('.inspect').isVisible(), false, 'two panels at one place');
  await page.locator('.program-row[data-line="10"]').click(); // to X8 Y1
  await page.locator('.canvas').focus();
  await page.keyboard.press('7');
  const marker = page.locator('.path-marker');
  await marker.waitFor();
  const [left, top, right] = await blockBox(viewer);
  const perMm = (right - left) / 24;
  const at = (x, y) => [left + (x + 12) * perMm, top + (10 - y) * perMm];
  await until('marker at the place', SETTLE_S, async () => {
    const box = await marker.boundingBox();
    const [x, y] = at(8, 1);
    return Math.hypot(box.x + box.width / 2 - x, box.y + box.height / 2 - y) < 3;
  });
  await page.mouse.click(...at(0, -6));
  await until('the line in the text', SETTLE_S, async () => {
    const line = await page.locator('.program-row.placed').getAttribute('data-line');
    return line === '6';
  });
}

/** A press on the plot over the program's time leads to the line and to the place. */
async function checkCut({ page }, session) {
  const { line, time_s: times } = await getJson(`${session}/programs/1/path`);
  const slider = page.getByRole('slider', { name: 'Position in the program' });
  await slider.waitFor();
  const total = Number(await slider.getAttribute('aria-valuemax'));
  const n = line.indexOf(10); // the second groove, to X8 Y1
  const share = (times[n - 1] + times[n]) / 2 / total;
  await slider.scrollIntoViewIfNeeded();
  const { x, y, width } = await slider.boundingBox();
  await page.mouse.click(x + PLOT_LEFT + share * (width - PLOT_LEFT - PLOT_RIGHT), y + 40);
  await until('the line in the text', SETTLE_S, async () => {
    const placed = await page.locator('.program-row.placed').getAttribute('data-line');
    return placed === '10';
  });
  const text = await page.locator('.cut-text').textContent();
  const [, force, removal] = /line 10: ([\d.]+) N, ([\d.]+) cm³\/min, 900 mm\/min/.exec(text) ?? [];
  assert(Number(force) > 1 && Math.abs(Number(removal) - GROOVE_CM3_PER_MIN) < 1, text);
  await slider.press('Home');
  assert.match(await page.locator('.cut-text').textContent(), /^0 s, line 5/);
}

async function test(folder) {
  const { server, base, session } = await startServer(options, folder, 'wall', SCENE);
  await carveProgram(session, PROGRAM, 'name=wall.ngc&pace=fast');
  const response = await fetch(`${session}/model.stl`);
  const stl = Buffer.from(await response.arrayBuffer());
  const corners = stlCorners(stl);
  await withBrowser(async (browser) => {
    const [width, height] = SIZES.at(-1);
    const address = `${base}/?session=wall&quality=full`;
    const others = { reducedMotion: 'reduce' };
    const viewer = await openViewer(browser, address, { width, height }, others);
    const { page, state, problems } = viewer;
    await until('picture', SETTLE_S, async () => (await state())?.snapshotComplete);
    await page.locator('input[name="material"]').nth(2).check({ force: true });
    await page.getByRole('button', { name: 'Sections and measurements' }).click();
    await page.getByRole('heading', { name: 'Inspect' }).waitFor();
    await checkAreas(page, corners);
    await checkCap(viewer);
    await checkMeasures(viewer);
    await checkCurvature(viewer);
    await checkMaker(viewer);
    await checkOwners(viewer);
    await checkDeviation(viewer, stl);
    await checkAccessible(page, 'the panel of sections and measures');
    for (const size of SIZES) {
      await checkFreeBlock(viewer, size, ['.bar', '.toolbar', '.panel', '.inspect']);
      const file = join(options.out, `inspect-${size[0]}.png`);
      await writeFile(file, await page.screenshot());
    }
    await page.setViewportSize({ width, height });
    await checkPath(viewer);
    await checkCut(viewer, session);
    await checkAccessible(page, 'the panel of programs');
    await writeFile(join(options.out, 'path.png'), await page.screenshot());
    assert.deepEqual(problems, []);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
