// SPDX-License-Identifier: Apache-2.0
// End-to-end test of carving in a headset: an emulated one (iwer) enters, carves a stroke, undoes and
// redoes it, sees another participant's hand, scales the block and returns to the page. See README.md.
//
// node vr_live.mjs --server PROGRAM --agent PROGRAM --carve PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { restingBlock } from './support/block.mjs';
import { openViewer, withBrowser } from './support/browser.mjs';
import { aboutX, Headset, headsetScript, turnedX } from './support/headset.mjs';
import { run, start, stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { getJson, optionsOf, runTest, startServer } from './support/session.mjs';

const options = optionsOf(['server', 'agent', 'carve', 'web', 'out']);

const SETTLE_S = 60; // software WebGL on a busy machine
const VIEWPORT = { width: 480, height: 360 };
const SCENE = boxScene(
  'Carve in a headset',
  [-20, -15, -10],
  [20, 15, 0],
  [cutter(1, 'ball', 6), cutter(4, 'flat', 8)],
  { machine: { kinematics: 'tool-vector' } },
);
// Where the page puts the block at first: 0.45 m long, its foot 0.9 m high and 0.55 m ahead.
const M_PER_MM = 0.45 / 40;
const AHEAD_M = 0.22; // the tip of a tool that large
const DEPTH_MM = 2;
const FROM_MM = -8;
const TO_MM = 8;
const DOWN = aboutX(-Math.PI / 2); // the grip's -Z, where the tip is, points to the floor
const PANEL_TURN = -0.28 * Math.PI; // about X, against the grip
const LEFT = [-0.22, 1.15, -0.35];
const UPRIGHT = [0, 0, 0, 1];
// Middles of buttons on the wrist panel, pixels; it has 640 x 448 and is 0.2 m wide.
const BUTTONS = { redo: [468, 282], next: [320, 196], leave: [517, 368] };

/** Where the right hand has a tool whose tip is at a place of the block, mm. */
function holding([x, y, z]) {
  return [x * M_PER_MM, 0.9 + (z + 10) * M_PER_MM + AHEAD_M, -0.55 - y * M_PER_MM];
}

/** The session once the server's block, as `isDone` says, is the page's. */
function settled({ session }, viewer, what, isDone) {
  return restingBlock(viewer, () => getJson(session), what, SETTLE_S, isDone);
}

/** Pulls the trigger over the block, moves through it, and lets go. */
async function stroke(headset) {
  const at = (x, trigger) => headset.hand('right', holding([x, 0, -DEPTH_MM]), DOWN, { trigger });
  await headset.hand('right', holding([FROM_MM, 0, 3]), DOWN, { trigger: 0 });
  await headset.frames(2);
  await at(FROM_MM, 0);
  await headset.frames(2);
  for (let x = FROM_MM; x <= TO_MM; x += 4) {
    await at(x, 1);
    await headset.frames(2);
  }
  await writeFile(join(options.out, 'vr-carving.png'), await headset.page.screenshot());
  await at(TO_MM, 0);
  await headset.frames(2);
  await headset.hand('right', holding([TO_MM, 0, 5]), DOWN);
}

/** Points at a button of the wrist panel and pulls the trigger. */
async function pressOnPanel(headset, name) {
  const [x, y] = BUTTONS[name];
  const metersPerPixel = 0.2 / 640;
  // A hand's breadth before the button, and turned as the panel is.
  const before = [(x - 320) * metersPerPixel, (224 - y) * metersPerPixel, 0.1];
  const offset = turnedX(before, PANEL_TURN);
  const panel = [LEFT[0], LEFT[1] + 0.1, LEFT[2] + 0.03];
  const hand = panel.map((value, i) => value + offset[i]);
  await headset.hand('right', hand, aboutX(PANEL_TURN), { trigger: 0 });
  await until(
    `${name} is pointed at`,
    SETTLE_S,
    async () => (await headset.state()).pointed === name,
  );
  if (name === 'redo')
    await writeFile(join(options.out, 'vr-panel.png'), await headset.page.screenshot());
  await headset.page.evaluate(() =>
    window.headset.controllers.right.updateButtonValue('trigger', 1),
  );
  if (name === 'leave') return;
  await headset.frames(2);
  await headset.hand('right', holding([0, 0, 10]), DOWN, { trigger: 0 });
  await headset.frames(2);
}

/** The export of the session, carved by kerf-carve, is the block. */
async function checkExport(server, folder, { state_hash: hash }) {
  const response = await fetch(`${server.session}/program.ngc`);
  await writeFile(join(folder, 'program.ngc'), await response.text());
  await writeFile(join(folder, 'scene.json'), JSON.stringify(SCENE));
  const report = join(folder, 'report.json');
  await run(options.carve, [
    ...['--scene', join(folder, 'scene.json'), '--program', join(folder, 'program.ngc')],
    ...['--report', report],
  ]);
  const { state_hash: carved } = JSON.parse(await readFile(report, 'utf8'));
  assert.equal(carved, hash, 'kerf-carve makes another block of the export');
}

async function checkStroke(server, viewer, headset, folder) {
  await stroke(headset);
  const cut = await settled(server, viewer, 'cut', ({ removed_volume_mm3: mm3 }) => mm3 > 0);
  // A ball's cap as the section, and at the ends half balls' caps.
  const [r, h] = [3, DEPTH_MM];
  const section = r * r * Math.acos(1 - h / r) - (r - h) * Math.sqrt(2 * r * h - h * h);
  const caps = (Math.PI * h * h * (3 * r - h)) / 3;
  const expected = section * (TO_MM - FROM_MM) + caps;
  const removed = cut.removed_volume_mm3;
  assert(Math.abs(removed / expected - 1) < 0.05, `${removed} mm³ instead of ${expected}`);
  await checkExport(server, folder, cut);
  assert((await headset.state()).pulses > 0, 'the controller does not pulse');
  return cut;
}

async function checkUndo(server, viewer, headset, { state_hash: hash }) {
  const isUncut = ({ removed_volume_mm3: mm3 }) => Math.abs(mm3) < 1e-6;
  await headset.press('right', 'a-button');
  await settled(server, viewer, 'undo', isUncut);
  await pressOnPanel(headset, 'redo');
  await settled(server, viewer, 'redo', (now) => now.state_hash === hash);
}

/** Others who carve have hands. */
async function checkOthers(server, headset) {
  const agent = start(options.agent, [
    ...['--server', server.base, '--session', 'vr', '--device', 'sim'],
    ...['--name', 'Ada', '--duration', '600', '--tool', '1'],
  ]);
  await until("another's hand", SETTLE_S, async () => (await headset.state()).others === 1);
  await headset.frames(2);
  await writeFile(join(options.out, 'vr-other.png'), await headset.page.screenshot());
  await stop(agent);
  await until('no other hand', SETTLE_S, async () => (await headset.state()).others === 0);
}

async function checkScale(headset) {
  const { scale } = await headset.state();
  const both = async (x, squeeze) => {
    await headset.hand('left', [-x, 1.1, -0.5], UPRIGHT, { squeeze });
    await headset.hand('right', [x, 1.1, -0.5], UPRIGHT, { squeeze });
    await headset.frames(2);
  };
  for (const x of [0.1, 0.15, 0.2]) await both(x, 1);
  await both(0.2, 0);
  await both(0.4, 0);
  const after = (await headset.state()).scale;
  assert(Math.abs(after / scale - 2) < 1e-6, `scaled by ${after / scale}`);
}

async function checkReturn(viewer, headset) {
  await headset.hand('left', LEFT, UPRIGHT);
  await pressOnPanel(headset, 'leave');
  await until('the page again', SETTLE_S, async () => (await headset.state()) === null);
  await viewer.page.locator('main[data-carve=off]').waitFor();
  const size = await viewer.page.evaluate(() => {
    const { width, height, clientWidth, clientHeight } = document.querySelector('canvas');
    return [width / clientWidth, height / clientHeight];
  });
  assert(Math.abs(size[0] - size[1]) < 0.02, `the picture is distorted: ${size}`);
  await writeFile(join(options.out, 'vr-after.png'), await viewer.page.screenshot());
}

async function checkWithoutHeadset(browser, url) {
  const { page } = await openViewer(browser, url, VIEWPORT);
  await page.getByRole('button', { name: 'Carve' }).waitFor();
  assert.equal(await page.getByRole('button', { name: 'Enter VR' }).count(), 0);
  await page.context().close();
}

async function test(folder) {
  const server = await startServer(options, folder, 'vr', SCENE);
  const url = `${server.base}/?session=vr&name=Grace`;
  await withBrowser(async (browser) => {
    await checkWithoutHeadset(browser, url);
    const viewer = await openViewer(browser, url, VIEWPORT, {
      script: await headsetScript(),
    });
    const { page, problems } = viewer;
    await until('picture', SETTLE_S, () => page.evaluate(() => window.kerf?.marks.picture));
    const headset = new Headset(page);
    await headset.look([0, 1.5, 0.1], aboutX(-0.7));
    await headset.hand('left', LEFT, UPRIGHT);
    await page.getByRole('button', { name: 'Enter VR' }).click();
    await page.locator('main[data-carve=ready]').waitFor();
    await until('frames', SETTLE_S, async () => (await headset.state())?.frames > 2);
    const isUncut = ({ removed_volume_mm3: mm3 }) => mm3 === 0;
    await settled(server, viewer, 'stock of the server in the page', isUncut);
    const cut = await checkStroke(server, viewer, headset, folder);
    await checkUndo(server, viewer, headset, cut);
    await checkOthers(server, headset);
    const { p50Ms, p95Ms, calls, triangles } = await headset.state();
    await checkScale(headset);
    await checkReturn(viewer, headset);
    assert.deepEqual(problems, []);
    console.log(
      `a frame: script ${p50Ms.toFixed(1)} ms (median), ${p95Ms.toFixed(1)} ms (95 %), ${calls} calls, ${triangles} triangles`,
    );
  });
  assert.equal(await stop(server.server), 0, server.server.errors);
}

await runTest(test, options.out);
