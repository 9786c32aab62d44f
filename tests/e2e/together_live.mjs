// SPDX-License-Identifier: Apache-2.0
// End-to-end test of viewers who work together: pins on the surface, views that others follow, the
// headline, large pictures, and the page in a frame. See README.md.
//
// node together_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { readFile, writeFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { join } from 'node:path';
import { checkAccessible } from './support/axe.mjs';
import { nextFrames, openViewer, withBrowser } from './support/browser.mjs';
import { checkFreeBlock } from './support/layout.mjs';
import { atEnd, stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { carveProgram, getJson, optionsOf, runTest, startServer } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const DESK = { width: 1000, height: 640 };
const PHONE = { width: 390, height: 844 };
const SCENE = boxScene('Wall', [-12, -10, -8], [12, 10, 0], [cutter(1, 'flat', 6)]);
const GROOVE = 'G21 G90\nT1 M6\nG0 X-16 Y0 Z-3\nG1 X16 F6000\nG0 Z20\nM30\n';
const SLOW = [
  'G21 G90\nT1 M6\nG0 X-16 Y6 Z-1\nF60',
  ...Array.from({ length: 128 }, (_, n) => `G1 X${-15.75 + n / 4}`),
  'M30\n',
].join('\n');

async function open(browser, base, name, viewport, others) {
  const address = `${base}/?session=wall&quality=full&name=${name}`;
  const viewer = await openViewer(browser, address, viewport, {
    reducedMotion: 'reduce',
    ...others,
  });
  await until('picture', SETTLE_S, async () => (await viewer.state())?.snapshotComplete);
  return viewer;
}

/** The middle of the only pin's mark in the picture. */
async function markOf({ page }) {
  const box = await page.locator('.pin-mark').boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
}

/** A pin is set where the block is pressed, is seen by others, and sinks with the surface. */
async function checkPin(ada, grace, session) {
  const { page, state } = ada;
  await page.getByRole('button', { name: 'Add a pin' }).click();
  await until('a hint', SETTLE_S, () => page.getByText('Click a spot').isVisible());
  await nextFrames(page);
  const [left, top, right, bottom] = (await state()).blockBox;
  const at = [(left + right) / 2, (2 * top + bottom) / 3];
  await page.mouse.click(...at);
  await page.getByRole('textbox', { name: 'Pin text' }).fill('deeper here?');
  await checkAccessible(page, 'the dialog of a pin');
  await page.keyboard.press('Enter');
  await grace.page
    .getByRole('list', { name: 'Pins' })
    .getByText('deeper here?')
    .waitFor({ state: 'attached' });
  const [pin] = (await getJson(`${session}/pins`)).pins;
  assert.equal(pin.author, 'Ada');
  assert(Math.abs(pin.at_mm[2]) < 0.01 && Math.abs(pin.at_mm[1]) < 6, `at ${pin.at_mm}`);
  await page.locator('.pin-mark').waitFor();
  const [x, y] = await markOf(ada);
  assert(Math.hypot(x - at[0], y - at[1]) < 3, `at ${x}, ${y} instead of ${at}`);
  await carveProgram(session, GROOVE, 'name=groove.ngc&pace=fast');
  await until('the pin on the ground of the groove', SETTLE_S, async () => {
    const pixels = (right - left) / 30; // of a millimeter, at least
    return (await markOf(ada))[1] - y > 1.5 * pixels;
  });
}

/** Ada follows Grace until she moves the picture herself. */
async function checkFollow(ada, grace) {
  const details = grace.page.getByRole('button', { name: 'Show more' });
  await details.click(); // on a phone the panel is a sheet
  await grace.page.getByRole('button', { name: 'Share my view' }).click();
  const chip = ada.page.getByRole('button', { name: /Follow(ing)? Grace/ });
  await chip.click();
  await grace.page.locator('.canvas').focus();
  await grace.page.keyboard.press('7');
  await until('the same view', SETTLE_S, async () => {
    const [mine, hers] = [await ada.state(), await grace.state()].map(({ camera }) => camera);
    return hers.eye[2] > 20 && mine.eye.every((value, n) => Math.abs(value - hers.eye[n]) < 0.01);
  });
  assert.equal(await chip.getAttribute('aria-pressed'), 'true');
  await ada.page.locator('.canvas').focus();
  await ada.page.keyboard.press('ArrowLeft');
  await until('her own view', SETTLE_S, async () => {
    return (await chip.getAttribute('aria-pressed')) === 'false';
  });
  await grace.page.getByRole('button', { name: 'Share my view' }).click();
  await chip.waitFor({ state: 'detached' });
}

async function checkHeadline({ page }, session) {
  const query = 'name=slow.ngc&pace=feed';
  const posted = await fetch(`${session}/programs?${query}`, {
    method: 'POST',
    body: SLOW,
  });
  assert.equal(posted.status, 202);
  const { url } = await posted.json();
  const headline = page.locator('.headline');
  await until('the headline', SETTLE_S, async () => {
    const text = await headline.textContent();
    return /slow\.ngc carves Wall · flat 6 mm\d+ %, 0:\d\d left/.test(text);
  });
  // The plots are loaded when there is something to plot.
  await until(
    'two plots',
    SETTLE_S,
    async () => (await page.locator('.plots .uplot').count()) === 2,
  );
  await fetch(new URL(url, session), { method: 'DELETE' });
}

async function checkPicture({ page }, out) {
  const coming = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save picture' }).click();
  const download = await coming;
  assert.equal(download.suggestedFilename(), 'Wall.png');
  const file = join(out, 'together-4k.png');
  await download.saveAs(file);
  const png = await readFile(file);
  const size = [png.readUInt32BE(16), png.readUInt32BE(20)];
  assert.deepEqual(size, [3840, Math.floor((3840 * DESK.height) / DESK.width)]);
}

/** Starts a site of another origin. The path of its page, after the first /, is what it frames. */
async function startSite() {
  const site = createServer(({ url }, response) => {
    const framed = decodeURIComponent(url.slice(1)).replaceAll('&', '&amp;');
    response.setHeader('Content-Type', 'text/html');
    response.end(`<!doctype html><iframe width="600" height="400" src="${framed}"></iframe>`);
  });
  await new Promise((resolve) => site.listen(0, 'localhost', resolve));
  atEnd(() => site.close());
  return { origin: `http://localhost:${site.address().port}` };
}

/** Opens a page of a site that frames an address; returns what is in the frame. */
async function frameIn(browser, { origin }, address) {
  const { page } = await openViewer(browser, `${origin}/${encodeURIComponent(address)}`, DESK);
  return page.frames()[1];
}

/** The page with ?embed is shown in frames of the named site, and changes nothing there. */
async function checkFramed(browser, base, named, other) {
  const address = `${base}/?session=wall&embed`;
  const frame = await frameIn(browser, named, address);
  await until('picture in the frame', SETTLE_S, () =>
    frame.evaluate(() => window.kerf?.marks.picture && window.kerf.state().snapshotComplete),
  );
  await frame.locator('.canvas').focus();
  for (const key of ['c', 't', 'i', '?', '7']) await frame.page().keyboard.press(key);
  await until('the view from above', SETTLE_S, () =>
    frame.evaluate(() => window.kerf.state().camera.eye[2] > 20),
  );
  for (const part of ['.carve-bar', '.timeline', '.inspect-panel', 'dialog[open]'])
    assert.equal(await frame.locator(part).count(), 0, part);
  await writeFile(join(options.out, 'embedded.png'), await frame.page().screenshot());
  await frame.page().close();
  for (const [site, refused] of [
    [other, address],
    [named, `${base}/?session=wall`],
  ]) {
    const blocked = await frameIn(browser, site, refused);
    // A process of its own reports the frame, perhaps later than its page.
    await until(`no ${refused} in ${site.origin}`, SETTLE_S, () =>
      blocked.url().startsWith('chrome-error:'),
    );
    await blocked.page().close();
  }
}

async function checkEmbedded(browser, base) {
  const { page, state } = await openViewer(browser, `${base}/?session=wall&embed`, PHONE);
  await until('picture', SETTLE_S, async () => (await state())?.snapshotComplete);
  for (const part of ['.bar', '.toolbar', '.panel'])
    assert.equal(await page.locator(part).isVisible(), false, part);
  assert(await page.locator('.canvas').isVisible());
  await page.close();
}

async function test(folder) {
  const [named, other] = [await startSite(), await startSite()];
  const others = ['--embed-origin', named.origin];
  const started = await startServer({ ...options, others }, folder, 'wall', SCENE);
  const { server, base, session } = started;
  await withBrowser(async (browser) => {
    const ada = await open(browser, base, 'Ada', DESK);
    const grace = await open(browser, base, 'Grace', PHONE, {
      colorScheme: 'dark',
      hasTouch: true,
    });
    await checkPin(ada, grace, session);
    await checkFollow(ada, grace);
    await checkHeadline(ada, session);
    await checkPicture(ada, options.out);
    await checkAccessible(ada.page, 'a page with a pin');
    for (const [viewer, size] of [
      [ada, [320, 640]],
      [ada, [844, 390]],
      [ada, [DESK.width, DESK.height]],
      [grace, [PHONE.width, PHONE.height]],
    ]) {
      if (viewer === grace) await grace.page.getByRole('button', { name: 'Show less' }).click();
      await viewer.page.keyboard.press('f');
      await checkFreeBlock(viewer, size, ['.bar', '.toolbar', '.panel']);
      await nextFrames(viewer.page);
      const file = join(options.out, `together-${size[0]}.png`);
      await writeFile(file, await viewer.page.screenshot());
    }
    await checkEmbedded(browser, base);
    await checkFramed(browser, base, named, other);
    await grace.page.getByRole('button', { name: 'Show more' }).click();
    await grace.page.getByRole('button', { name: 'Remove the pin “deeper here?”' }).click();
    await ada.page.locator('.pin-mark').waitFor({ state: 'detached' });
    assert.deepEqual([...ada.problems, ...grace.problems], []);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
