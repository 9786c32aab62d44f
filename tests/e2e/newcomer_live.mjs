// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the front page: from an empty server to a program that runs in a block of
// one's own, a model with a fault, a price. See README.md.
//
// node newcomer_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { openViewer, withBrowser } from './support/browser.mjs';
import { stop, until } from './support/processes.mjs';
import { getJson, optionsOf, runTest, startEmptyServer } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const PROGRAM = [
  '(T5 D=4. CR=2. - ball end mill)',
  ...['G21 G90', 'T5 M6', 'S10000 M3', 'G0 X0 Y0 Z5', 'G1 Z-1.5 F300'],
  ...[10, 20, 30].flatMap((y) => [`G1 X40 Y${y - 5}`, `G1 X0 Y${y}`]),
  ...['G0 Z5', 'M30', ''],
].join('\n');
/** A tetrahedron without its fourth side. */
const OPEN_STL = `solid open
${['0 0 0 0 10 0 10 0 0', '0 0 0 10 0 0 0 0 10', '0 0 0 0 0 10 0 10 0']
  .map((side) => {
    const n = side.split(' ');
    const corner = (at) => `vertex ${n[at]} ${n[at + 1]} ${n[at + 2]}`;
    return `facet normal 0 0 0\nouter loop\n${[0, 3, 6].map(corner).join('\n')}\nendloop\nendfacet`;
  })
  .join('\n')}
endsolid open
`;

/** Of the accuracy that a block has at first. */
const PRICE = /^[\d.]+\smm: up to .*B of memory, .*s to join$/;

function file(name, text) {
  return { name, mimeType: 'text/plain', buffer: Buffer.from(text) };
}

async function keep(page, name) {
  await writeFile(join(options.out, `${name}.png`), await page.screenshot({ fullPage: true }));
}

/** Makes the next pages note in `playback` that they have shown the past. */
async function notePlayback(page) {
  await page.addInitScript(() => {
    new MutationObserver(() => {
      if (document.querySelector('.past-banner:not([hidden])')) window.playback = 'shown';
    }).observe(document, { subtree: true, childList: true, attributes: true });
  });
}

/** Chooses a program and creates its block, as somebody does who reads nothing. */
async function runProgram({ page, state }, base) {
  const began = Date.now();
  await page.goto(base);
  await page.getByLabel('Run an NC program').setInputFiles(file('first part.ngc', PROGRAM));
  const create = page.getByRole('button', { name: 'Create and run' });
  await page.getByText(PRICE).waitFor();
  assert.equal(await page.getByLabel('Diameter of tool 5, mm').inputValue(), '4');
  assert.equal(await page.getByLabel('Shape of tool 5').inputValue(), 'ball');
  assert.equal(await page.getByLabel('Stock from Z, mm').inputValue(), '-4');
  assert.equal(await page.getByLabel('Stock to X, mm').inputValue(), '42');
  await keep(page, 'lobby-program');
  await notePlayback(page);
  await create.click();
  await page.waitForURL(`${base}/?session=first-part`);
  await until('the finished program', SETTLE_S, async () => {
    const { programs } = await getJson(`${base}/v1/sessions/first-part/programs`);
    return programs[0]?.motions_done > 0 && programs[0].state === 'finished';
  });
  console.log(`a program is carved after ${((Date.now() - began) / 1000).toFixed(1)} s`);
  await until('block', SETTLE_S, async () => (await state())?.snapshotComplete);
  await page.getByRole('heading', { name: 'first part', exact: true }).waitFor();
  await page.waitForFunction(() => window.playback === 'shown');
  await page.locator('.past-banner').waitFor({ state: 'hidden' });
}

/** A fault of a program or a model is shown where it was chosen, and the rest stays of use. */
async function checkFaults(page, base) {
  await page.goto(`${base}/?list`);
  await page.getByLabel('Run an NC program').setInputFiles(file('a.ngc', 'G21\nG1 X5 Q\nM30\n'));
  await page.getByRole('alert').getByText('2: G1 X5 Q', { exact: true }).waitFor();
  await page.getByLabel('Carve a model').setInputFiles(file('open.stl', OPEN_STL));
  await page
    .getByRole('alert')
    .getByText(/open edge/)
    .waitFor();
  await page.getByRole('button', { name: 'Close holes' }).click();
  await page.getByText('Repaired: closed 1 hole (the longest boundary: 42.4 mm).').waitFor();
  await page.getByLabel('Unit of the model').selectOption('inch');
  await page.getByText('254.0 × 254.0 × 254.0 mm, from X 0.0', { exact: false }).waitFor();
  await page.getByText(PRICE).waitFor();
  await keep(page, 'lobby-repaired');
  await page.getByLabel('Carve a model').setInputFiles(file('a.step', 'ISO-10303-21;'));
  await page
    .getByRole('alert')
    .getByText(/name ends in .stl/)
    .waitFor();
}

/**
 * Closes the session that the page shows, once the page has left it: it may still connect, and the
 * browser would report that there is no such session. Then the page shows the list.
 */
async function closeLeft(page, base, session) {
  await page.goto('about:blank');
  await fetch(`${base}/v1/sessions/${session}`, { method: 'DELETE' });
  await page.goto(`${base}/?list`);
}

/** A model is turned, scaled and moved; the block that is created is where the page said. */
async function placeModel(page, base) {
  await page.getByLabel('Carve a model').setInputFiles(file('part.stl', closedStl()));
  await page.getByText('10.0 × 10.0 × 10.0 mm', { exact: false }).waitFor();
  await page.getByText('Rotate, scale, move').click();
  await page.getByLabel('Rotate about Y, degrees').fill('30');
  await page.getByText('Up to 13.7 × 10.0 × 13.7 mm, from X 0.0', { exact: false }).waitFor();
  await page.getByLabel('Rotate about Y, degrees').fill('90');
  await page.getByLabel('Scale').fill('2');
  await page.getByLabel('Move along Z, mm').fill('-5');
  await page
    .getByText('20.0 × 20.0 × 20.0 mm, from X 0.0 Y 0.0 Z -25.0', {
      exact: false,
    })
    .waitFor();
  await page.getByText(PRICE).waitFor();
  await keep(page, 'lobby-placed');
  await page.getByRole('button', { name: 'Create', exact: true }).click();
  await page.waitForURL(`${base}/?session=part`);
  const { stock } = await getJson(`${base}/v1/sessions/part`);
  assert.deepEqual(
    [stock.min_mm, stock.max_mm],
    [
      [0, 0, -25],
      [20, 20, -5],
    ],
  );
  await closeLeft(page, base, 'part');
}

function closedStl() {
  const side = `facet normal 0 0 0
outer loop
vertex 10 0 0
vertex 0 10 0
vertex 0 0 10
endloop
endfacet
`;
  return OPEN_STL.replace('endsolid', `${side}endsolid`);
}

/** A template's block gets another size. */
async function sizeTemplate(page, base) {
  await page.getByRole('button', { name: /^Cylinder/ }).click();
  const create = page.getByRole('button', { name: 'Create', exact: true });
  await page.getByLabel('Diameter, mm').fill('30');
  await page.getByLabel('Height, mm').fill('0');
  await page.locator('.price.bad').waitFor();
  assert(await create.isDisabled());
  await page.getByLabel('Height, mm').fill('50');
  await page.locator('.price:not(.bad)').waitFor();
  await keep(page, 'lobby-size');
  await create.click();
  await page.waitForURL(`${base}/?session=bust`);
  const { stock } = await getJson(`${base}/v1/sessions/bust`);
  assert.deepEqual([stock.radius_mm, stock.min_z_mm, stock.max_z_mm], [15, -50, 0]);
  await closeLeft(page, base, 'bust');
}

/** The price follows the slider. */
async function checkPrice(page) {
  await page.getByRole('button', { name: 'Milling job' }).click();
  const price = page.locator('.price');
  const priceAt = async (place, target) => {
    await page.getByLabel('Accuracy').fill(place);
    await price.getByText(new RegExp(`^${target}\\smm:`)).waitFor();
    return (await price.textContent()).replace(/^.*up to /, '');
  };
  assert.notEqual(await priceAt('0', '1'), await priceAt('5', '0.02'));
}

async function checkCards(page) {
  const card = page.getByRole('link', { name: /first part/ });
  await card.getByText('44 × 34 × 4 mm', { exact: false }).waitFor();
  await until('picture of the block', SETTLE_S, () =>
    card.locator('img').evaluate((image) => image.complete && image.naturalWidth === 480),
  );
  await keep(page, 'lobby');
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.setViewportSize({ width: 390, height: 844 });
  await keep(page, 'lobby-dark-phone');
}

async function checkClosing(page, base) {
  await page.getByRole('button', { name: 'More for first part' }).click();
  await page.getByRole('button', { name: 'Close…', exact: true }).click();
  await page.getByRole('dialog').getByRole('button', { name: 'Close session' }).click();
  await page.getByText('Nothing here yet. Press “Carve a new block” to start.').waitFor();
  const { sessions } = await getJson(`${base}/v1/sessions`);
  assert.deepEqual(sessions, []);
}

async function test(folder) {
  const { server, base } = await startEmptyServer(options, folder);
  await withBrowser(async (browser) => {
    const viewer = await openViewer(browser, 'about:blank', {
      width: 1440,
      height: 900,
    });
    await runProgram(viewer, base);
    await checkFaults(viewer.page, base);
    await placeModel(viewer.page, base);
    await sizeTemplate(viewer.page, base);
    await checkPrice(viewer.page);
    await checkCards(viewer.page);
    // The browser reports the answers that are errors; the list may still ask for the picture of a
    // block that is closed.
    assert.deepEqual(
      viewer.problems.filter((text) => !text.includes('status of 400')),
      [],
    );
    await checkClosing(viewer.page, base);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
