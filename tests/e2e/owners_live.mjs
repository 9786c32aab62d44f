// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the colors that tell who cut what: two programs cut grooves that cross, and the
// page tells them apart in the picture, in the legend, and by the line that cut. See README.md.
//
// node owners_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { colorsAt } from './support/pictures.mjs';
import { checkFreeBlock } from './support/layout.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { carveProgram, getJson, optionsOf, runTest, startServer } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 90; // software WebGL on a busy machine
const SIZES = [
  [844, 390],
  [390, 844],
  [1024, 720],
];
const SCENE = boxScene('Cross', [-20, -15, -10], [20, 15, 0], [cutter(1, 'flat', 6)], {
  accuracy: { rays: 'tri-dexel' },
});
const LENGTH_MM = 30; // of a groove, with its ends
const WIDTH_MM = 6;

/** A groove in the middle of the block, 4 mm deep. */
const groove = (from, to) => `G21 G90
T1 M6
S10000 M3
G0 ${from} Z5
G1 Z-4 F900
G1 ${to}
G0 Z5
M30
`;

/** Where a place on top of the block is in the picture, which is seen from above in parallel. */
async function seen({ state }, x, y) {
  const [left, top, right, bottom] = (await state()).blockBox;
  return [left + ((x + 20) / 40) * (right - left), top + ((15 - y) / 30) * (bottom - top)];
}

const hueOf = ([r, g, b]) => {
  const [high, low] = [Math.max(r, g, b), Math.min(r, g, b)];
  if (high - low < 0.2 * high) return null; // gray, in light that is not
  const part =
    high === r
      ? (g - b) / (high - low)
      : high === g
        ? 2 + (b - r) / (high - low)
        : 4 + (r - g) / (high - low);
  return (60 * part + 360) % 360;
};

const hueOfHex = (hex) => hueOf([1, 3, 5].map((n) => parseInt(hex.slice(n, n + 2), 16)));

/** Whether places of the picture have these hues; null: gray. */
async function areHued(viewer, wanted) {
  const pixels = [];
  for (const [[x, y]] of wanted) pixels.push((await seen(viewer, x, y)).map(Math.round));
  const hues = (await colorsAt(viewer, pixels)).map(hueOf);
  return wanted.every(([, hue], n) => {
    if (hue === null || hues[n] === null) return hue === hues[n];
    return Math.abs(((hues[n] - hue + 540) % 360) - 180) < 14;
  });
}

const legend = (page) => page.getByRole('list', { name: 'Who cut what' });

/** The rows of the legend, and whether a hint is shown: of one moment, because both change. */
function legendNow(page) {
  return page.locator('.owners').evaluate((owners) => ({
    waits: owners.querySelector('[role=status]').checkVisibility(),
    rows: [...owners.querySelectorAll('.owner-legend button')].map((row) => ({
      name: row.querySelector('.owner-name').textContent,
      percent: parseFloat(row.querySelector('.owner-share').textContent),
      color: /#[0-9a-f]{6}/i.exec(row.querySelector('.owner-color').getAttribute('style'))[0],
    })),
  }));
}

/** The hint is gone when the whole surface has colors; names may come later. */
async function colored(page) {
  return until('all colors', SETTLE_S, async () => {
    const { waits, rows } = await legendNow(page);
    const names = rows.map(({ name }) => name).sort();
    return !waits && names.join() === 'first.ngc,second.ngc' && rows;
  });
}

/** The first groove has its walls but where the second crosses it, and all of its ground. */
function expectedShare() {
  const depth = 4;
  const ends = Math.PI * (WIDTH_MM / 2) * depth + Math.PI * (WIDTH_MM / 2) ** 2;
  const straight = LENGTH_MM - WIDTH_MM;
  const first = straight * WIDTH_MM + ends + 2 * (straight - WIDTH_MM) * depth;
  const shorter = 24 - WIDTH_MM; // the second one's straight part
  const second = (shorter - WIDTH_MM) * WIDTH_MM + ends + 2 * (shorter - WIDTH_MM) * depth;
  return (100 * first) / (first + second);
}

async function checkColors(viewer) {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Color by participant' }).click();
  const rows = await colored(page);
  console.log(rows.map(({ name, percent, color }) => `${name} ${percent} % ${color}`).join(', '));
  const [first, second] = ['first.ngc', 'second.ngc'].map((name) =>
    rows.find((row) => row.name === name),
  );
  const expected = expectedShare();
  assert(Math.abs(first.percent - expected) < 1.5, `${first.percent} % instead of ${expected} %`);
  assert(Math.abs(first.percent + second.percent - 100) < 0.2);
  const [one, other] = [first, second].map(({ color }) => hueOfHex(color));
  const places = [
    [[-10, 0], one],
    [[0, 0], one], // was there first
    [[10, 0], one],
    [[0, 8], other],
    [[0, -8], other],
  ];
  await until('the colors in the picture', SETTLE_S, () => areHued(viewer, places));
  await legend(page).getByRole('button', { name: 'second.ngc' }).click();
  await nextFrames(page);
  await writeFile(join(options.out, 'owners-alone.png'), await page.screenshot());
  const alone = [
    [[-10, 0], null],
    [[0, 8], other],
  ];
  await until('the second alone', SETTLE_S, () => areHued(viewer, alone));
  await legend(page).getByRole('button', { name: 'second.ngc' }).click();
}

/** Mouse, finger and key find who cut a place, also while it is being cut. */
async function checkTip(viewer, session) {
  const { page } = viewer;
  const tip = page.locator('.owner-tip');
  const tells = (...texts) =>
    until(`tip with ${texts}`, SETTLE_S, async () => {
      const shown = (await tip.isVisible()) ? await tip.textContent() : '';
      return texts.every((text) => shown.includes(text));
    });
  await page.mouse.move(...(await seen(viewer, 0, 8)));
  await tells('second.ngc', 'line 6', '6 mm');
  const row = (await legendNow(page)).rows.find(({ name }) => name === 'second.ngc');
  const dot = await tip.locator('.owner-color').getAttribute('style');
  assert.equal(/#[0-9a-f]{6}/i.exec(dot)[0], row.color);
  await checkAccessible(page, 'who cut the place under the pointer');
  await writeFile(join(options.out, 'owners-tip.png'), await page.screenshot());
  await page.keyboard.press('Escape');
  assert(!(await tip.isVisible()), 'Escape hides the tip');
  await page.touchscreen.tap(...(await seen(viewer, 8, 0)));
  await tells('first.ngc', 'line 6');
  await page.mouse.move(5, 5);
  await page.locator('.canvas').focus();
  await page.keyboard.press('Enter'); // the middle, where the first one was before the second
  await tells('first.ngc', 'line 6');
  await page.mouse.move(...(await seen(viewer, 14, 10)));
  await tells('Original stock surface, not cut yet.');
  await carveProgram(session, groove('X14 Y10', 'X13'), 'name=third.ngc&pace=fast');
  await tells('third.ngc');
}

/** The ground of the second groove leads to the line, in the text and in the picture. */
async function checkLine(viewer) {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Who cut this?' }).click();
  await page.mouse.click(...(await seen(viewer, 0, 8)));
  await page.getByText('Cut by second.ngc in line 6, with tool 1').waitFor();
  await page.getByRole('button', { name: 'Show line' }).first().click();
  await page.locator('.programs').waitFor(); // a chunk of its own
  const placed = page.locator('.program-row.placed');
  await placed.waitFor();
  assert.equal(await placed.getAttribute('data-line'), '6');
  assert.match(await page.locator('.program-text').textContent(), /G1 Y9/);
  await page.locator('.path-marker').waitFor();
  await until('marker at the place, beside the panel', SETTLE_S, async () => {
    const box = await page.locator('.path-marker').boundingBox();
    const panel = await page.locator('.programs').boundingBox();
    const [x, y] = await seen(viewer, 0, 8);
    const isThere = box && Math.hypot(box.x + box.width / 2 - x, box.y + box.height / 2 - y) < 8;
    return isThere && box.x > panel.x + panel.width;
  });
  const [row, panel] = [await placed.boundingBox(), await page.locator('.programs').boundingBox()];
  assert(
    row.y > panel.y && row.y + row.height <= panel.y + panel.height,
    'the line is not in view',
  );
}

async function test(folder) {
  const { server, base, session } = await startServer(options, folder, 'cross', SCENE);
  await carveProgram(session, groove('X-12 Y0', 'X12'), 'name=first.ngc&pace=fast');
  await carveProgram(session, groove('X0 Y-9', 'Y9'), 'name=second.ngc&pace=fast');
  const { authors } = await getJson(`${session}/authors`);
  assert.deepEqual(
    authors.map(({ name, kind }) => [name, kind]),
    [
      ['first.ngc', 'program'],
      ['second.ngc', 'program'],
    ],
  );
  await withBrowser(async (browser) => {
    const [width, height] = SIZES.at(-1);
    const size = { width, height };
    const address = `${base}/?session=cross`;
    const viewer = await openViewer(browser, address, size, {
      reducedMotion: 'reduce',
      hasTouch: true,
    });
    const { page, state, problems } = viewer;
    await until('picture', SETTLE_S, async () => (await state())?.snapshotComplete);
    await page.getByRole('button', { name: 'Sections and measurements' }).click();
    await page.getByRole('button', { name: 'Parallel', exact: true }).click();
    await page.locator('.canvas').focus();
    await page.keyboard.press('7');
    await nextFrames(page);
    await checkColors(viewer);
    await checkAccessible(page, 'the colors of people');
    await page.keyboard.press('0');
    for (const each of SIZES) {
      await checkFreeBlock(viewer, each, ['.bar', '.toolbar', '.panel', '.inspect']);
      await page.locator('.owners').evaluate((one) => one.scrollIntoView({ block: 'nearest' }));
      await nextFrames(page);
      await writeFile(join(options.out, `owners-${each[0]}.png`), await page.screenshot());
    }
    await page.setViewportSize({ width: 1440, height: 900 });
    await page.locator('.canvas').focus();
    await page.keyboard.press('7');
    await nextFrames(page);
    await checkTip(viewer, session);
    await checkLine(viewer);
    await writeFile(join(options.out, 'owners-line.png'), await page.screenshot());
    assert.deepEqual(problems, []);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
