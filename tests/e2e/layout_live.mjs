// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the page's layout in each of its states, from 320 to 2560 pixels, upright and
// lying, light and dark: nothing lies on another, nothing leaves the window, and axe finds nothing.
// See README.md.
//
// node layout_live.mjs --server PROGRAM --web FOLDER --out FOLDER [--sizes all]
// [--schemes dark]

import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { boxesIn, intersecting, outside } from './support/layout.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { carveProgram, optionsOf, runTest, startServer } from './support/session.mjs';
import { clashesIn } from './support/texts.mjs';

const options = optionsOf(['server', 'web', 'out'], {
  sizes: 'some',
  schemes: 'light,dark',
});

const SETTLE_S = 60; // software WebGL on a busy machine
const LAYOUT_S = 30; // each size that has a fault takes so long
const SOME = [
  [320, 640],
  [844, 390],
  [1024, 768],
  [1440, 900],
];
const ALL = [
  ...SOME,
  ...[360, 390, 412, 480, 540, 600].map((width) => [width, 2 * width]),
  ...[568, 667, 736, 915].map((width) => [width, 375]),
  ...[640, 768, 820, 900, 960, 1000, 1080, 1180, 1280, 1366].map((width) => [width, 760]),
  [768, 1024],
  [820, 1180],
  [1920, 1080],
  [2560, 1440],
];
const SIZES = options.sizes === 'all' ? ALL : SOME;
const SCENE = boxScene(
  'Wall',
  [-12, -10, -8],
  [12, 10, 0],
  [cutter(1, 'flat', 6), cutter(2, 'ball', 4)],
);
/** A rapid motion goes through the stock: an alarm. */
const RAPID = 'G21 G90\nT1 M6\nG0 X-16 Y0 Z5\nG0 Z-3\nG0 X16\nG1 Y6 F6000\nG1 X-16\nG0 Z20\nM30\n';
/** What may lie over the picture. */
const OVER = [
  '.bar',
  '.main-actions',
  '.toolbar',
  '.panel',
  '.programs',
  '.inspect',
  '.timeline',
  '.carve-bar',
];

const toggle = (name) => async (page) => {
  await page.getByRole('button', { name, exact: true }).dispatchEvent('click');
};
const state = (name, part, open, close = open) => ({ name, part, open, close });
const dialog = (name, opens, part) =>
  state(
    name,
    part,
    (page) => page.locator(opens).dispatchEvent('click'),
    (page) => page.keyboard.press('Escape'),
  );

async function pressAlarm(page) {
  await toggle('NC programs')(page);
  await page.locator('.program-alarms button').first().click();
}

/** States of the page of a session; `part` is there in it. */
const STATES = [
  state('viewing', '.panel', () => undefined),
  state('inspecting', '.inspect', toggle('Sections and measurements')),
  state('timeline', '.timeline', toggle('Timeline')),
  state(
    'carving',
    '.carve-bar',
    (page) => page.keyboard.press('c'),
    (page) => page.keyboard.press('Escape'),
  ),
  // Last: it moves the camera, and the picture is not fitted to the window then.
  state('alarm', '.program-alarms button', pressAlarm, toggle('NC programs')),
];
const DIALOGS = [
  dialog('help', '.help-button', 'dialog.help[open]'),
  dialog('take home', '.take-button', 'dialog.take-home'),
];

/** Faults of the layout, in words. */
async function faultsOf({ page, state: stateOf }, [width, height], name) {
  const boxes = await boxesIn(page, OVER);
  if (name !== 'alarm') {
    const block = (await stateOf()).blockBox;
    return [
      ...(await intersecting(page, OVER, [block])),
      ...outside([...boxes, ['block', block]], [width, height]),
    ];
  }
  // The place that the alarm leads to is not hidden.
  const [marker] = await boxesIn(page, ['.path-marker']);
  const listed = await page
    .locator('.program-list')
    .evaluate((list) => list.clientHeight >= list.querySelector('button').offsetHeight);
  return [
    ...(listed ? [] : ['the list of programs is cut off']),
    ...outside(boxes, [width, height]),
    ...(await intersecting(page, [...OVER, '.path-marker'])),
    ...(marker ? [] : ['no place of the alarm']),
  ];
}

async function checkSizes(viewer, name, scheme) {
  const { page } = viewer;
  const bad = [];
  for (const size of SIZES) {
    await page.setViewportSize({ width: size[0], height: size[1] });
    let faults = [];
    await until('layout', LAYOUT_S, async () => {
      await nextFrames(page);
      faults = await faultsOf(viewer, size, name);
      return faults.length === 0;
    }).catch(() => undefined);
    for (const fault of faults) bad.push(`${name}, ${scheme}, ${size.join(' × ')}: ${fault}`);
    if (faults.length > 0 || SIZES === SOME)
      await writeFile(
        join(options.out, `layout-${name}-${scheme}-${size.join('x')}.png`),
        await page.screenshot({ timeout: 120_000 }),
      );
  }
  return bad;
}

async function checkDialog({ page }, part, name) {
  const bad = [];
  const scrolled = await page.locator(part).evaluate(({ scrollTop }) => scrollTop);
  if (scrolled > 0) bad.push(`${name}: its beginning is out of sight, ${scrolled} pixels above`);
  for (const size of SIZES) {
    await page.setViewportSize({ width: size[0], height: size[1] });
    await nextFrames(page);
    bad.push(
      ...outside(await boxesIn(page, [part]), size).map((fault) => `${name}: ${fault}`),
      ...(await clashesIn(page, part)).map((fault) => `${name}, ${size.join(' × ')}: ${fault}`),
    );
  }
  return bad;
}

/** The list of sessions: nothing wider than the window, no text on another. */
async function checkLobby({ page }, scheme) {
  const bad = [];
  for (const step of ['lobby', 'new block']) {
    if (step === 'new block') {
      await page.locator('.choices button').first().click();
      await until('price', SETTLE_S, () => page.locator('.price').innerText());
    }
    for (const size of SIZES) {
      await page.setViewportSize({ width: size[0], height: size[1] });
      await nextFrames(page);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      if (wide > size[0]) bad.push(`${step}, ${size.join(' × ')}: ${wide} pixels wide`);
      bad.push(
        ...(await clashesIn(page, '.new-block')).map((one) => `${step} ${size.join()}: ${one}`),
      );
    }
    await checkAccessible(page, `${step}, ${scheme}`);
  }
  return bad;
}

async function sweep(browser, base, scheme) {
  const viewer = await openViewer(
    browser,
    `${base}/?session=wall&name=Ada`,
    { width: 1440, height: 900 },
    { colorScheme: scheme, reducedMotion: 'reduce' },
  );
  const { page, problems } = viewer;
  await until('picture', SETTLE_S, async () => (await viewer.state())?.snapshotComplete);
  const bad = [];
  for (const { name, part, open, close } of STATES) {
    await open(page);
    await page.locator(part).first().waitFor();
    bad.push(...(await checkSizes(viewer, name, scheme)));
    await checkAccessible(page, `${name}, ${scheme}`);
    await close(page);
  }
  for (const { name, part, open, close } of DIALOGS) {
    await open(page);
    await page.locator(part).waitFor();
    bad.push(...(await checkDialog(viewer, part, name)));
    await checkAccessible(page, `${name}, ${scheme}`);
    await close(page);
  }
  await page.goto(`${base}/?list`);
  await page.locator('.choices').waitFor();
  bad.push(...(await checkLobby(viewer, scheme)));
  assert.deepEqual(problems, []);
  await page.context().close();
  console.log(bad.join('\n'));
  console.log(`${scheme}: ${STATES.length + DIALOGS.length + 2} states at ${SIZES.length} sizes`);
  return bad;
}

async function test(folder) {
  const { server, base, session } = await startServer(options, folder, 'wall', SCENE);
  await carveProgram(session, RAPID, 'dialect=linuxcnc&pace=fast&name=wall.ngc');
  await withBrowser(async (browser) => {
    const bad = [];
    for (const scheme of options.schemes.split(','))
      bad.push(...(await sweep(browser, base, scheme)));
    assert.deepEqual(bad, []);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
