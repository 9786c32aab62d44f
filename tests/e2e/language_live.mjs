// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the page's languages: a German browser shows no English text, in the session's
// page, its panels and dialogs and in the lobby; long words lie on nothing, from 320 pixels on. See
// README.md.
//
// node language_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { checkFreeBlock } from './support/layout.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { carveProgram, optionsOf, runTest, startServer } from './support/session.mjs';
import { clashesIn, textsIn } from './support/texts.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const DESK = { width: 1440, height: 900 };
const SMALL = { width: 320, height: 640 };
const SCENE = boxScene('Wall', [-12, -10, -8], [12, 10, 0], [cutter(1, 'flat', 6)]);
const GROOVE = 'G21 G90\nT1 M6\nG0 X-16 Y0 Z-3\nG1 X16 F600\nG0 Z20\nM30\n';
/** What is the same in both: names, formats, units, what the server and the browser say. */
const SAME =
  /^(Kerf|Wall|wall|wall\.ngc|[\da-f]{16}|Aluminium|NC|Web|Ada.*|Live|live|Material|Radius|Name|Parallel|Esc|[CGN]\d.*|GLB.*|3MF|APT|CAD|CAM|CSV|OBJ|PLY|STL|Pins|Details|Downloads|[\d.,:/ ]*(mm|mm³|cm³|cm³\/min|N|N·mm|ms|s)?)$/;

function button(n) {
  return `.toolbar > :nth-child(${n})`;
}

/** What opens, and the element that is then there. A press on `closes` closes it, or Escape. */
const PARTS = [
  { opens: '.help-button', part: 'dialog.help[open]' },
  { opens: '.main-action-download', part: 'dialog.take-home' },
  { opens: button(1), part: '.programs', closes: '.programs header button' },
  { opens: button(2), part: '.inspect', closes: button(2) },
  { opens: button(3), part: '.timeline', closes: button(3) },
];

async function open(browser, base, locale, viewport, colorScheme) {
  const viewer = await openViewer(browser, `${base}/?session=wall&name=Ada`, viewport, {
    locale,
    colorScheme,
    reducedMotion: 'reduce',
  });
  await until('picture', SETTLE_S, async () => (await viewer.state())?.snapshotComplete);
  return viewer;
}

/** Opens one part after the other, and calls `look` with its selector while it is open. */
async function eachPart({ page }, look) {
  await look('body', 'main > :is(.bar, .main-actions, .toolbar, .panel)');
  for (const { opens, part, closes } of PARTS) {
    await page.locator(opens).dispatchEvent('click'); // on a phone it may be in a closed sheet
    await page.locator(part).waitFor();
    await nextFrames(page);
    await look(part, part);
    if (closes) await page.locator(closes).dispatchEvent('click');
    else await page.keyboard.press('Escape');
    await page.locator(part).waitFor({ state: 'hidden' });
  }
}

/** All texts of the page and the lobby. */
async function reported(viewer, base) {
  const texts = new Set();
  await eachPart(viewer, async () => {
    for (const text of await textsIn(viewer.page)) texts.add(text);
  });
  await viewer.page.goto(`${base}/?list`);
  await viewer.page.locator('.choices').waitFor();
  for (const text of await textsIn(viewer.page)) texts.add(text);
  return texts;
}

async function checkTexts(browser, base) {
  const english = await reported(await open(browser, base, 'en-US', DESK), base);
  const viewer = await open(browser, base, 'de-AT', DESK);
  assert.equal(await viewer.page.locator('html').getAttribute('lang'), 'de');
  const german = await reported(viewer, base);
  assert(german.has('Zeitleiste') && german.size > 150, `${german.size} texts`);
  const left = [...german].filter((text) => english.has(text) && /[A-Za-z]{2}/.test(text));
  assert.deepEqual(
    left.filter((text) => !SAME.test(text)),
    [],
  );
}

/** Nothing lies on anything, and no rule of WCAG is violated, in German. */
async function checkLayout(browser, base, viewport, colorScheme) {
  const viewer = await open(browser, base, 'de-DE', viewport, colorScheme);
  const { page, problems } = viewer;
  const { width, height } = viewport;
  await checkFreeBlock(viewer, [width, height], ['.bar', '.toolbar', '.panel']);
  await eachPart(viewer, async (part, selector) => {
    assert.deepEqual(await clashesIn(page, selector), [], `${part} at ${width} pixels`);
    const name = part.replaceAll(/[^a-z-]/g, '');
    const png = await page.screenshot();
    await writeFile(join(options.out, `german-${width}-${name}.png`), png);
  });
  await checkAccessible(page, 'the German page');
  assert.deepEqual(problems, []);
}

/** The choice in the panel counts more than the browser, and stays. */
async function checkChoice(browser, base) {
  const { page } = await open(browser, base, 'en-US', DESK);
  await page.getByRole('combobox', { name: 'Language' }).selectOption('zh');
  await page.getByRole('heading', { name: '参与者' }).waitFor();
  await page.reload();
  await page.getByRole('combobox', { name: '语言' }).waitFor();
}

async function test(folder) {
  const { server, base, session } = await startServer(options, folder, 'wall', SCENE);
  await carveProgram(session, GROOVE, 'name=wall.ngc&pace=fast');
  await withBrowser(async (browser) => {
    await checkTexts(browser, base);
    await checkLayout(browser, base, DESK, 'light');
    await checkLayout(browser, base, SMALL, 'dark');
    await checkChoice(browser, base);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
