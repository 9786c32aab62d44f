// SPDX-License-Identifier: Apache-2.0
// End-to-end test of a newcomer's path to a first cut, by visible text alone and with at most two
// presses: on a server that has no session yet, with an invitation, in kerf.html, and in that page as
// one file that a browser opens from a folder; in Chromium and Firefox, on a desk and on a phone. See
// README.md.
//
// node first_cut_live.mjs --server PROGRAM --web FOLDER --out FOLDER [--users all]

import assert from 'node:assert/strict';
import { copyFile, mkdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openViewer, withBrowser } from './support/browser.mjs';
import { serveFiles } from './support/file_host.mjs';
import { fingerRests } from './support/finger.mjs';
import { openInFirefox, withFirefox } from './support/firefox.mjs';
import { poll, stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { getJson, optionsOf, runFilesTest, startEmptyServer } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out'], { users: 'some' });

const SETTLE_S = 90; // software WebGL on a busy machine
const DESK = { width: 1280, height: 800 };
const PHONE = { width: 390, height: 844 };
const GIFT = boxScene('Gift', [-40, -30, -20], [40, 30, 0], [cutter(1, 'ball', 8)]);
/** Who tries: the browser, and its window. Some: each browser, each window. */
const ALL = {
  'chromium-phone': PHONE,
  firefox: DESK,
  chromium: DESK,
  'firefox-phone': PHONE,
};
const USERS = Object.entries(ALL).slice(0, options.users === 'all' ? 4 : 2);
/** A cut is brighter than the block's skin, by this in red, green and blue together. */
const BRIGHTER = 90;
const CUT_PIXELS = 120; // of the part that is looked at, at least
const LOOKS_S = 4; // after a try; on a busy machine its picture comes late

/** A person at Chromium, with a mouse or a finger. */
async function chromiumUser(browser, url, viewport, hasTouch) {
  const { page, problems } = await openViewer(browser, url, viewport, {
    hasTouch,
  });
  const text = (shown) => page.getByText(shown, { exact: true }).filter({ visible: true });
  return {
    page,
    problems,
    look: () => page.screenshot({ timeout: 120_000 }),
    press: (shown) => (hasTouch ? text(shown).tap() : text(shown).click()),
    boxOf: (shown) => text(shown).boundingBox(),
    drag: hasTouch ? (points) => dragByCdp(page, points) : (points) => dragMouse(page, points),
    close: () => page.context().close(),
  };
}

/** A person at Firefox. */
async function firefoxUser(browser, url, viewport, hasTouch) {
  const others = hasTouch ? { hasTouch: true, isMobile: false } : {};
  const { page, problems, close } = await openInFirefox(browser, url, {
    ...viewport,
    ...others,
  });
  const find = async (shown) => {
    const isIt = (text) =>
      [...document.querySelectorAll('body *')].findLast(
        (one) => one.textContent.trim() === text && one.checkVisibility(),
      );
    return (await page.waitForFunction(isIt, {}, shown)).asElement();
  };
  return {
    page,
    problems,
    look: async () => Buffer.from(await page.screenshot()),
    press: async (shown) => (await find(shown)).click(),
    boxOf: async (shown) => (await find(shown)).boundingBox(),
    drag: hasTouch
      ? (points) => dragByTouchscreen(page, points)
      : (points) => dragMouse(page, points),
    close,
  };
}

async function dragMouse({ mouse }, [first, ...others]) {
  await mouse.move(...first);
  await mouse.down();
  for (const point of others) await mouse.move(...point);
  await mouse.up();
}

async function dragByCdp(page, points) {
  const session = await page.context().newCDPSession(page);
  const send = (type, touches) =>
    session.send('Input.dispatchTouchEvent', {
      type,
      touchPoints: touches.map(([x, y]) => ({ x, y })),
    });
  await send('touchStart', [points[0]]);
  await fingerRests();
  for (const point of points.slice(1)) await send('touchMove', [point]);
  await send('touchEnd', []);
  await session.detach();
}

async function dragByTouchscreen({ touchscreen }, [first, ...others]) {
  const finger = await touchscreen.touchStart(...first);
  await fingerRests();
  for (const point of others) await finger.move(...point);
  await finger.end();
}

/** How many pixels of a part of two pictures are brighter in the second: left, top, width, height. */
async function brighterPixels({ page }, before, after, box) {
  return page.evaluate(
    async ([pictures, [left, top, width, height], step]) => {
      const [one, other] = await Promise.all(
        pictures.map(async (base64) => {
          const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
          const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
          const scale = bitmap.width / innerWidth;
          const context = new OffscreenCanvas(width, height).getContext('2d');
          context.scale(1 / scale, 1 / scale);
          context.drawImage(bitmap, -left * scale, -top * scale);
          return context.getImageData(0, 0, width, height).data;
        }),
      );
      let count = 0;
      for (let at = 0; at < one.length; at += 4) {
        const change = [0, 1, 2].reduce((sum, n) => sum + other[at + n] - one[at + n], 0);
        if (change > step) count += 1;
      }
      return count;
    },
    [[before, after].map((png) => png.toString('base64')), box, BRIGHTER],
  );
}

/** The middle of the free part of the picture: left of the panel, or above the bar of tools on a phone. */
async function middleOf(user, { width, height }) {
  if (width > height) return [(await user.boxOf('Removed')).x / 2, height / 2];
  return [width / 2, (await user.boxOf('Depth')).y / 2];
}

/**
 * Drags across the block until there is a cut: as somebody does whose first try came too early. Each
 * try is beside the last one, because a groove that is cut deeper becomes no brighter.
 */
async function cut(user, viewport) {
  await user.boxOf('Depth'); // the bar of tools is there
  let tries = 0;
  return until('a cut in the picture', SETTLE_S, async () => {
    const [x, middle] = (await middleOf(user, viewport)).map(Math.round);
    const y = middle + 10 * (tries++ % 4);
    const before = await user.look();
    const points = [-40, -15, 10, 40].map((along) => [x + along, y + 2]);
    await user.drag(points);
    return poll(LOOKS_S, async () => {
      const after = await user.look();
      // Without the place of the tool, which stays at the end; and beside the stroke, where a
      // picture that was taken while the browser drew it would be brighter too.
      const brighterIn = (box) => brighterPixels(user, before, after, box);
      const cutPixels = await brighterIn([x - 50, y - 20, 70, 40]);
      const others = await brighterIn([x - 50, y + 30, 70, 40]);
      return cutPixels >= CUT_PIXELS && others < CUT_PIXELS / 10 && after;
    });
  });
}

/** A press on one text, and a stroke. */
async function atServer(user, base, name, viewport) {
  const began = Date.now();
  await user.page.goto(base);
  await user.press('Carve a new block');
  const picture = await cut(user, viewport);
  console.log(`${name}, at a server: a cut after ${seconds(began)}`);
  await writeFile(join(options.out, `first-cut-${name}.png`), picture);
  const { sessions } = await getJson(`${base}/v1/sessions`);
  assert.equal(sessions.length, 1);
  await isCutAtServer(`${base}/v1/sessions/${sessions[0].id}`, {});
}

/** The page shows the cut of its copy before the server has made it. */
async function isCutAtServer(session, headers) {
  await until('cut at the server', SETTLE_S, async () => {
    const answer = await fetch(session, { headers });
    return answer.ok && (await answer.json()).removed_volume_mm3 > 0;
  });
}

/** Somebody who was sent the link of an invitation: a press on one text, and a stroke. */
async function invited(user, name, viewport, folder) {
  await mkdir(folder, { recursive: true });
  const file = join(folder, 'admin');
  const others = ['--admin-token-file', file];
  const { server, base } = await startEmptyServer({ ...options, others }, folder);
  const token = (await readFile(file, 'ascii')).trim();
  const headers = { authorization: `Bearer ${token}` };
  const session = `${base}/v1/sessions/gift`;
  const body = JSON.stringify(GIFT);
  const created = await fetch(`${base}/v1/sessions?id=gift`, { method: 'POST', headers, body });
  assert.equal(created.status, 201, await created.text());
  const made = await fetch(`${session}/invitations?role=sculptor`, { method: 'POST', headers });
  const { link } = await made.json();
  const began = Date.now();
  await user.page.goto(new URL(link, base).href);
  await user.press('Carve');
  await cut(user, viewport);
  console.log(`${name}, invited: a cut after ${seconds(began)}`);
  await isCutAtServer(session, headers);
  await user.page.goto('about:blank'); // else it misses its server
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

/** No press at all: the page opens on a block. */
async function withoutServer(user, url, name, viewport) {
  const began = Date.now();
  await user.page.goto(url);
  const picture = await cut(user, viewport);
  console.log(`${name}: a cut after ${seconds(began)}`);
  await writeFile(join(options.out, `first-cut-${name}.png`), picture);
}

/** The page as one file, outside its folder; its help is a key away. */
async function fromFile(user, name, viewport, folder) {
  const file = join(folder, 'kerf.html');
  await copyFile(join(options.web, 'kerf-single.html'), file);
  await withoutServer(user, pathToFileURL(file).href, `${name}-file`, viewport);
  await user.page.keyboard.press('?');
  assert(await user.boxOf('Show the whole block'), 'no help');
}

function seconds(began) {
  return `${((Date.now() - began) / 1000).toFixed(1)} s`;
}

async function carveAll(user, name, viewport, host, folder) {
  const { server, base } = await startEmptyServer(options, folder);
  await atServer(user, base, name, viewport);
  await invited(user, name, viewport, join(folder, 'invited'));
  // Last, because the page asks about unsaved strokes before it is left.
  await withoutServer(user, `${host.base}/kerf.html`, `${name}-local`, viewport);
  if (name.startsWith('chromium')) await fromFile(user, name, viewport, folder);
  assert.deepEqual(user.problems, []);
  await user.close();
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

async function test(folder) {
  const host = await serveFiles(options.web);
  for (const [kind, withIt, userOf] of [
    ['chromium', withBrowser, chromiumUser],
    ['firefox', withFirefox, firefoxUser],
  ])
    await withIt(async (browser) => {
      for (const [name, viewport] of USERS.filter(([each]) => each.startsWith(kind))) {
        const user = await userOf(browser, 'about:blank', viewport, viewport === PHONE);
        await carveAll(user, name, viewport, host, join(folder, name));
      }
    });
}

await runFilesTest(test, options);
