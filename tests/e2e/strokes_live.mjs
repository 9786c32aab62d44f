// SPDX-License-Identifier: Apache-2.0
// End-to-end test of copies: two pages draw random strokes by mouse with two tools and undo some,
// over lines that break, while an agent carves. In the end the copies of both pages are the server's
// block, and so is the export. With many strokes it is a soak. See README.md.
//
// node strokes_live.mjs --server PROGRAM --agent PROGRAM --carve PROGRAM --web FOLDER
//   [--strokes 10000] [--seed 1]

import assert from 'node:assert/strict';
import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { openViewer, withBrowser } from './support/browser.mjs';
import { run, start, stop, until } from './support/processes.mjs';
import { getJson, optionsOf, runTest, startServer } from './support/session.mjs';
import { slowLine } from './support/slow_line.mjs';

const options = optionsOf(['server', 'agent', 'carve', 'web'], {
  strokes: '8',
  seed: '1',
});

const SETTLE_S = 90; // software WebGL on a busy machine
const ONE_WAY_MS = 40;
const VIEWPORT = { width: 900, height: 640 }; // smaller, the bars cover the block
const UNDO_SHARE = 0.15;
const TOOL_SHARE = 0.3; // of the strokes after which another tool is taken
const CUT_SHARE = 0.15; // of the strokes during which a line breaks
const CONNECTED_SHARE = 0.9; // of the strokes before which a page waits for its line
const REST_MS = 12_000; // longer than a page waits before it tries its line again
// So large that thousands of strokes, 1 mm deep, do not go through it.
const SCENE = {
  name: 'Strokes',
  stock: { shape: 'box', min_mm: [-400, -300, -300], max_mm: [400, 300, 0] },
  accuracy: {
    rays: 'dexel',
    pitch_mm: 4,
    tolerance_mm: 0.05,
    motion: 'tight',
  },
  tools: [
    { id: 1, shape: 'ball', diameter_mm: 24, length_mm: 400 },
    { id: 2, shape: 'flat', diameter_mm: 30, length_mm: 400 },
  ],
  machine: { kinematics: 'tool-vector' },
};

/** Numbers from 0 to 1, the same for a seed (mulberry32). */
function randomOf(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
}

async function enter(browser, server, name) {
  const line = await slowLine(server.base, ONE_WAY_MS);
  const viewer = await openViewer(browser, `${line.base}/?session=strokes&name=${name}`, VIEWPORT);
  await until('picture', SETTLE_S, () => viewer.page.evaluate(() => window.kerf?.marks.picture));
  await viewer.page.keyboard.press('c');
  await viewer.page.locator('main[data-carve=ready]').waitFor();
  return {
    ...viewer,
    line,
    input: await viewer.page.context().newCDPSession(viewer.page),
  };
}

/** The events of a mouse, sent at once: the browser takes them in their order, as fast as it can. */
function mouse(input, type, [x, y]) {
  const isHeld = type !== 'mouseReleased';
  return input.send('Input.dispatchMouseEvent', {
    ...{ type, x, y, button: 'left', buttons: isHeld ? 1 : 0, clickCount: 1 },
  });
}

async function drag({ page, state, line, input }, random) {
  const [left, top, right, bottom] = (await state()).blockBox;
  if (random() < CONNECTED_SHARE)
    await until('connection', SETTLE_S, async () => (await state()).status === 'connected');
  const place = () => [
    left + (0.25 + 0.5 * random()) * (right - left),
    top + (0.25 + 0.4 * random()) * (bottom - top),
  ];
  const [from, over, to] = [place(), place(), place()];
  const between = (a, b, share) => a.map((value, n) => value + share * (b[n] - value));
  const cuts = random() < CUT_SHARE;
  const steps = [1 / 3, 2 / 3, 1];
  const sent = [
    page.mouse.move(...from),
    mouse(input, 'mousePressed', from),
    ...steps.map((share) => mouse(input, 'mouseMoved', between(from, over, share))),
    ...steps.map((share) => mouse(input, 'mouseMoved', between(over, to, share))),
    mouse(input, 'mouseReleased', to),
  ];
  if (cuts) line.cut();
  await Promise.all(sent);
  await page.locator('main[data-carve=ready]').waitFor();
  if (random() < UNDO_SHARE) await page.keyboard.press('Control+z');
  if (random() < TOOL_SHARE) await page.keyboard.press(']');
}

/** Waits until the server is at rest. */
async function settled({ session }) {
  return until('rest', SETTLE_S, async () => {
    const before = await getJson(session);
    await new Promise((resolve) => setTimeout(resolve, REST_MS));
    const now = await getJson(session);
    return before.state_hash === now.state_hash && before.motions === now.motions && now;
  });
}

async function checkExport({ session }, folder, hash) {
  const file = (name) => join(folder, name);
  const response = await fetch(`${session}/program.ngc`);
  await writeFile(file('program.ngc'), await response.text());
  await writeFile(file('scene.json'), JSON.stringify(SCENE));
  await run(options.carve, [
    ...['--scene', file('scene.json'), '--program', file('program.ngc')],
    ...['--report', file('report.json')],
  ]);
  const { state_hash: carved } = JSON.parse(await readFile(file('report.json'), 'utf8'));
  assert.equal(carved, hash, 'kerf-carve makes another block of the export');
}

async function test(folder) {
  const server = await startServer(options, folder, 'strokes', SCENE);
  const draws = async (browser) => {
    const pages = [];
    for (const name of ['Ada', 'Grace']) pages.push(await enter(browser, server, name));
    const agent = start(options.agent, [
      ...['--server', server.base, '--session', 'strokes', '--device', 'sim'],
      ...['--loop', '--duration', '86400', '--name', 'Mary', '--tool', '1'],
    ]);
    const strokes = Number(options.strokes);
    let drawn = 0;
    let ends = false;
    process.once('SIGINT', () => (ends = true)); // what is drawn by then is compared
    const draw = async (page, seed) => {
      const random = randomOf(seed);
      for (let n = 0; n < strokes / 2 && !ends; ++n) {
        await drag(page, random);
        if (++drawn % 100 === 0) console.log(`${drawn} strokes`);
      }
    };
    await Promise.all(pages.map((page, n) => draw(page, 2 * Number(options.seed) + n)));
    // While another tool has no pose yet, the copies still get the cuts of the agent.
    for (const { page } of pages) await page.keyboard.press(']');
    await stop(agent);
    const { state_hash: hash, motions } = await settled(server);
    for (const { page } of pages) {
      await until('the copy of a page', SETTLE_S, async () => {
        const copy = await page.evaluate(() => window.kerf.copyHash());
        return copy === hash;
      });
    }
    await checkExport(server, folder, hash);
    const after = await getJson(server.session);
    assert.equal(after.state_hash, hash, 'the block has changed since it was at rest');
    console.log(`${drawn} strokes by pages, ${motions} motions in all: ${hash}`);
  };
  // By default Playwright ends this program at a SIGINT.
  await withBrowser(draws, undefined, { handleSIGINT: false });
  assert.equal(await stop(server.server), 0, server.server.errors);
}

await runTest(test);
