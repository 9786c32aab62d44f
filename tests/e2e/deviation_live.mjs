// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the comparison with a part: the part is the model of another session, from which
// the block differs by a groove that is too deep and one that is too short. See README.md.
//
// node deviation_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { countPixels, untilStill } from './support/pictures.mjs';
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
const TOO_DEEP_MM = 0.3;
const GROOVE_MM = 4;
const SCENE = boxScene('Bracket', [-20, -15, -10], [20, 15, 0], [cutter(1, 'flat', GROOVE_MM)], {
  accuracy: { rays: 'tri-dexel' },
});

/** Two grooves along X; `depth` of the first, `end` of the second. */
function program(depth, end) {
  return `G21 G90
T1 M6
S10000 M3
G0 X-14 Y-7 Z5
G1 Z${-depth} F900
G1 X14
G0 Z5
G0 X-14 Y5
G1 Z-5
G1 X${end}
G0 Z5
M30
`;
}

async function partOf(base) {
  const body = JSON.stringify(SCENE);
  const created = await fetch(`${base}/v1/sessions?id=part`, {
    method: 'POST',
    body,
  });
  assert.equal(created.status, 201);
  const session = `${base}/v1/sessions/part`;
  await carveProgram(session, program(5, 14), 'name=part.ngc&pace=fast');
  return Buffer.from(await (await fetch(`${session}/model.stl`)).arrayBuffer());
}

const figures = (page) => page.locator('.deviation .inspect-figures').textContent();
const hint = (page) => page.locator('.deviation > [role=status]').textContent();

/** Within, least and greatest, once all of the surface is measured. */
async function found(page) {
  return until('figures', SETTLE_S, async () => {
    if ((await hint(page)) !== '') return null;
    const text = (await figures(page)).replaceAll('−', '-');
    const match = /([\d.]+) % within tolerance([+-][\d.]+) to ([+-][\d.]+) mm/.exec(text);
    if (!match) return null;
    const [within, least, greatest] = match.slice(1).map(Number);
    return { within, least, greatest };
  });
}

async function add(page, name, buffer) {
  await page.locator('.deviation input[type=file]').setInputFiles({
    name,
    mimeType: 'model/stl',
    buffer,
  });
}

/** Red and blue pixels of the block, as the colors show what was left and what is too deep. */
async function colored(viewer) {
  await untilStill(viewer);
  const [left, top, right, bottom] = (await viewer.state()).blockBox;
  const box = [left, top, right - left, bottom - top].map(Math.round);
  const red = await countPixels(viewer, box, { leastRedOverBlue: 70 });
  const others = await countPixels(viewer, box, { leastRedOverBlue: -45 });
  return { red, blue: box[2] * box[3] - others };
}

async function checkFound(viewer, session) {
  const { page } = viewer;
  const { within, least, greatest } = await found(page);
  assert(Math.abs(least + TOO_DEEP_MM) < 0.005, `least ${least} mm`);
  // In the middle of the remaining material the edges of the groove are nearest. Points are a pitch apart.
  const missed = GROOVE_MM / 2 - greatest;
  assert(missed > -0.01 && missed < SCENE.accuracy.pitch_mm / 2, `greatest ${greatest} mm`);
  const survey = await getJson(`${session}/targets/part.stl/deviation`);
  const tolerance = Number(await page.getByRole('spinbutton', { name: 'Tolerance' }).inputValue());
  const inside = survey.quantiles_mm.filter((mm) => Math.abs(mm) <= tolerance).length;
  assert(Math.abs(within - inside / 10) < 0.5, `${within} % instead of ${inside / 10} %`);
  await page.locator('.canvas').focus();
  await page.keyboard.press('7'); // from above
  const { red, blue } = await until('colors', SETTLE_S, async () => {
    const pixels = await colored(viewer);
    return pixels.red > 200 && pixels.blue > 200 && pixels;
  });
  console.log(`${within} % within ${tolerance} mm, ${red} red and ${blue} blue pixels`);
}

/** A press on a place of the list shows it in the picture, and leads to the line that cut it. */
async function checkPlaces({ page }) {
  const place = page.getByRole('list', { name: 'Largest deviations' }).getByText('−0.3').first();
  await place.click();
  const label = page.locator('.measure-label', { hasText: '−0.3 mm' });
  const { width: wide, height } = page.viewportSize();
  await until('the place in the picture', SETTLE_S, async () => {
    const box = await label.boundingBox();
    if (!box) return false;
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    return x > 0.2 * wide && x < 0.9 * wide && y > 0.1 * height && y < 0.9 * height;
  });
  await page.locator('.deviation').getByText('Cut by bracket.ngc in line').waitFor();
}

async function checkLine({ page }) {
  const text = await page.locator('.deviation .probe-text').textContent();
  const [, line] = /in line (\d+)/.exec(text);
  assert(line === '5' || line === '6', `${text}: not a line of the groove that is too deep`);
  await page.locator('.deviation').getByRole('button', { name: 'Show line' }).click();
  const placed = page.locator('.program-row.placed');
  await placed.waitFor();
  assert.equal(await placed.getAttribute('data-line'), line);
}

/** A program that is watched while it runs: where it cuts into the part is listed, and is shown. */
async function checkGouge({ page }) {
  await page.getByRole('combobox', { name: 'Part the program makes' }).waitFor();
  await page.locator('.programs').getByRole('spinbutton', { name: 'Tolerance' }).fill('0.2');
  const shallow = program(5, 14).replace('Y-7', 'Y-1').replace('Z-5', 'Z-1.5');
  const text = shallow.replace('F900', 'F450'); // it runs for 10 s, also on a busy machine
  await page.getByLabel('Run speed').selectOption('pace=feed');
  await page.locator('.program-file').setInputFiles({
    name: 'deep.ngc',
    mimeType: 'text/plain',
    buffer: Buffer.from(text),
  });
  await page.getByText('Watching for gouges into part.stl deeper than 0.2 mm.').waitFor();
  const alarm = page.locator('.program-alarms').getByText('Gouge into the part');
  const shown = await until('the alarm while the program runs', SETTLE_S, () =>
    page.evaluate(() => {
      const { state } = document.querySelector('.program-row-button[aria-pressed=true]').dataset;
      const texts = [...document.querySelectorAll('.program-alarms button')].map(
        (button) => button.textContent,
      );
      return state === 'running' && texts.find((one) => one.includes('Gouge into the part'));
    }),
  );
  const line = /lines? (\d+)/.exec(shown)[1];
  assert(['5', '6'].includes(line), shown);
  const depth = await until('the depth of the groove', SETTLE_S, async () => {
    const [, mm, z] = /part, ([\d.]+) mm, limit 0\.2: .* Z (-[\d.]+)/.exec(
      await alarm.first().textContent(),
    );
    return mm === '1.5' && { mm, z };
  });
  assert.equal(depth.z, '-1.5');
  await alarm.first().click();
  await page.locator(`.program-row.marked[data-line='${line}']`).waitFor();
  await checkAccessible(page, 'a program with a gouge');
  await page.locator('.program-row-button[aria-pressed=true][data-state=finished]').waitFor();
}

async function test(folder) {
  const { server, base, session } = await startServer(options, folder, 'bracket', SCENE);
  await carveProgram(session, program(5 + TOO_DEEP_MM, 8), 'name=bracket.ngc&pace=fast');
  const stl = await partOf(base);
  await withBrowser(async (browser) => {
    const [width, height] = SIZES.at(-1);
    const address = `${base}/?session=bracket`;
    const viewer = await openViewer(
      browser,
      address,
      { width, height },
      { reducedMotion: 'reduce' },
    );
    const { page, state, problems } = viewer;
    await until('picture', SETTLE_S, async () => (await state())?.snapshotComplete);
    await page.getByRole('button', { name: 'Sections and measurements' }).click();
    await page.getByText('Add a model of the finished part').waitFor();
    await add(page, 'part.stl', stl);
    await checkFound(viewer, session);
    await checkAccessible(page, 'the comparison with a part');
    await page.keyboard.press('0');
    for (const size of SIZES) {
      await page.setViewportSize({ width: size[0], height: size[1] });
      await nextFrames(page);
      await checkFreeBlock(viewer, size, ['.bar', '.toolbar', '.panel', '.inspect']);
      await page.locator('.deviation').evaluate((one) => one.scrollIntoView({ block: 'start' }));
      await nextFrames(page);
      const file = join(options.out, `deviation-${size[0]}.png`);
      await writeFile(file, await page.screenshot());
    }
    await checkPlaces(viewer);
    await writeFile(join(options.out, 'deviation-place.png'), await page.screenshot());
    await checkLine(viewer);
    await checkGouge(viewer);
    await writeFile(join(options.out, 'gouge.png'), await page.screenshot());
    assert.deepEqual(problems, []);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
