// SPDX-License-Identifier: Apache-2.0
// End-to-end test: the real server, two agents carving one block at 1 kHz, two browsers and a
// viewer without a browser. At the end all of them must have the same block, and all downloads must
// be valid. See README.md.
//
// node carve_live.mjs --server PROGRAM --agent PROGRAM --carve PROGRAM --web FOLDER --out FOLDER
// [--motions N]

import assert from 'node:assert/strict';
import { readFile, writeFile, stat } from 'node:fs/promises';
import { join } from 'node:path';
import { openViewer, withBrowser } from './support/browser.mjs';
import { photograph } from './support/pictures.mjs';
import { gltfErrors, stlFacts, tilesOf } from './support/checks.mjs';
import { METER, read, reset } from './support/meter.mjs';
import { run, start, stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { getJson, optionsOf, runTest, startServer } from './support/session.mjs';
import { WireViewer } from './support/wire_viewer.mjs';

const options = optionsOf(['server', 'agent', 'carve', 'web', 'out'], {
  motions: '2000',
});

const SESSION = 'e2e';
const SETTLE_S = 90; // software WebGL on a busy machine
const SCENE = boxScene(
  'end to end',
  [-30, -30, -20],
  [30, 30, 0],
  [cutter(1, 'ball', 6), cutter(2, 'flat', 4)],
  { machine: { kinematics: 'tool-vector' } }, // the agents tilt their tools
);

let step = 0;
function logStep(text) {
  console.log(`${String(++step).padStart(2)}  ${text}`);
}

async function download(url, file) {
  const response = await fetch(url);
  assert.equal(response.status, 200, `${url} answered ${response.status}`);
  const bytes = Buffer.from(await response.arrayBuffer());
  await writeFile(file, bytes);
  return bytes;
}

async function openViewers(base, browser) {
  const viewers = await Promise.all(
    ['Grace', 'Mary'].map((name) =>
      openViewer(
        browser,
        `${base}/?session=${SESSION}&name=${name}`,
        { width: 900, height: 560 },
        { script: METER },
      ),
    ),
  );
  const wire = new WireViewer(base, SESSION);
  for (const { state } of viewers)
    await until(
      'complete block in a browser',
      SETTLE_S,
      async () => (await state())?.snapshotComplete,
    );
  await until('complete block in the wire viewer', SETTLE_S, () => wire.snapshotComplete);
  logStep('two browsers and a wire viewer have the complete block');
  return { viewers, wire };
}

/** It carves a figure, which takes it some 40 s, unless it is stopped before. */
function startAgent(base, folder, name, tool, color) {
  return start(options.agent, [
    '--server',
    base,
    '--session',
    SESSION,
    '--device',
    'sim',
    '--name',
    name,
    '--color',
    color,
    '--tool',
    String(tool),
    '--status-json',
    join(folder, `${name}.json`),
  ]);
}

/** Presses the button of the sound, and waits until the audio context follows. */
async function switchSound(viewer, on) {
  const button = viewer.page.getByRole('button', { name: 'Sound' });
  assert.equal(await button.getAttribute('aria-pressed'), String(!on));
  await button.click();
  assert.equal(await button.getAttribute('aria-pressed'), String(on));
  await until('sound on or off', SETTLE_S, async () => {
    const { sound } = await viewer.state();
    return sound?.context === (on ? 'running' : 'suspended') && sound;
  });
}

/** Carves the motions of the options, and until all has been seen; a busy page draws late. */
async function carve(base, folder, viewers) {
  assert.equal((await viewers[0].state()).sound, null, 'a page sounds that nobody asked to');
  await switchSound(viewers[0], true);
  assert.equal((await viewers[0].state()).sound.noise, 0);
  const { page } = viewers[0];
  await until('picture', SETTLE_S, () => page.evaluate(() => window.kerf.marks.picture));
  await reset(page);
  const agents = [
    startAgent(base, folder, 'Ada', 1, '#c2410c'),
    startAgent(base, folder, 'Linus', 2, '#0f766e'),
  ];
  const seen = await until('two tools, a force and its sound', SETTLE_S, async () => {
    const { participants, sound } = await viewers[0].state();
    const carvers = participants.filter(({ kind }) => kind === 'agent');
    return (
      carvers.length === 2 &&
      carvers.every(({ forceSamples }) => forceSamples > 0) &&
      carvers.some(({ peakForceN }) => peakForceN > 0) &&
      sound.tone > 0 &&
      sound.loudest > 0 &&
      carvers
    );
  });
  assert.deepEqual(seen.map(({ name, color }) => `${name} ${color}`).sort(), [
    'Ada #c2410c',
    'Linus #0f766e',
  ]);
  const { programs } = await until('a picture of them', SETTLE_S, async () => {
    const all = await read(page);
    return all.pictures.length > 0 && all;
  });
  assert.deepEqual(programs, [], 'shaders of the tools are compiled when they appear');
  await switchSound(viewers[0], false);
  const variance = await photograph(viewers[0], join(options.out, 'carving.png'));
  await until(`${options.motions} motions`, SETTLE_S, async () => {
    const { motions } = await getJson(`${base}/v1/sessions/${SESSION}`);
    return motions >= Number(options.motions);
  });
  const codes = await Promise.all(agents.map((agent) => stop(agent)));
  for (const [n, { name, errors, lines }] of agents.entries())
    assert.equal(codes[n], 0, `${name}: ${errors}${lines.join('\n')}`);
  logStep(
    `two agents carved ${options.motions} motions at 1 kHz; a browser displayed tools and forces`,
  );
  return variance;
}

/**
 * Waits until all viewers have the server's newest state, and compares them. Its meshes have been
 * sent before it, but a page decodes them beside: it may display the last ones later.
 */
async function compare(base, viewers, wire) {
  const session = await getJson(`${base}/v1/sessions/${SESSION}`);
  assert(session.motions > 1000, `only ${session.motions} motions were carved`);
  assert(session.removed_volume_mm3 > 1, `only ${session.removed_volume_mm3} mm³ were removed`);
  const settled = (state) =>
    state?.settled && (state.hash ?? state.state_hash) === session.state_hash;
  const versions = ({ tiles }) => tiles.map(({ x, y, version }) => [x, y, version]);
  const states = await until('settled browsers', SETTLE_S, async () => {
    const all = await Promise.all(viewers.map(({ state }) => state()));
    const [one, other] = all.map(versions);
    assert(all.every(settled), 'a browser has another state');
    assert.deepEqual(one, other, 'the browsers display different tiles');
    return all;
  });
  await until('settled wire viewer', SETTLE_S, () => {
    assert(settled(wire.state), `it has ${JSON.stringify(wire.state)} ${wire.errors}`);
    return true;
  });
  const [first] = states;
  assert.equal(first.motions, session.motions);
  for (const state of states) assert.equal(state.problems, 0, state.problem);
  for (const { problems } of viewers) assert.deepEqual(problems, []);
  assert.deepEqual(wire.errors, []);
  logStep(
    `server and viewers agree: state ${session.state_hash}, ${session.motions} motions, ` +
      `${first.triangles} triangles`,
  );
  return session;
}

/** Returns the newest version of each tile that the wire viewer received. */
function newestTiles(wire) {
  return [...new Map(wire.glbs.flatMap(tilesOf).map((tile) => [tile.tile, tile])).values()];
}

function trianglesOf(tiles) {
  return tiles.reduce((sum, { triangles }) => sum + triangles, 0);
}

/**
 * Checks that distant viewers get coarser tiles and near viewers exact ones, and that a browser
 * requests both: coarser ones while its picture moves, exact ones at rest.
 */
async function compareDetail(viewer, wire) {
  const exact = newestTiles(wire);
  assert(
    exact.every(({ level }) => level === 0),
    'a viewer that sent no camera received coarse tiles',
  );
  await viewer.page.locator('.canvas').focus();
  const { keyboard } = viewer.page;
  for (let i = 0; i < 6; ++i) await keyboard.press('-');
  let presses = 0;
  const away = await until('coarse tiles while the picture moves', SETTLE_S, async () => {
    await keyboard.press(presses++ % 2 === 0 ? '-' : '+'); // a picture at rest has exact ones
    const state = await viewer.state();
    return 2 * state.triangles < trianglesOf(exact) && state;
  });
  const still = await until('exact tiles at rest', SETTLE_S, async () => {
    const state = await viewer.state();
    return state.tiles.every(({ level }) => level === 0) && state;
  });
  assert.equal(still.triangles, trianglesOf(exact));
  assert.equal(still.problems, 0, still.problem);

  wire.sendLook([0, 0, 5000], 0.01);
  // Flat tiles are exact at each level.
  await until('coarsest tiles in the wire viewer', SETTLE_S, () => {
    const levels = newestTiles(wire).map(({ level }) => level);
    return levels.includes(3) && levels.every((level) => level === 3 || level === 0);
  });
  const coarse = trianglesOf(newestTiles(wire));
  assert(3 * coarse < trianglesOf(exact), `${coarse} of ${trianglesOf(exact)} triangles`);
  wire.sendLook([0, 0, 5000], 0);
  await until('exact tiles in the wire viewer', SETTLE_S, () =>
    newestTiles(wire).every(({ level }) => level === 0),
  );
  assert.deepEqual(newestTiles(wire), exact);
  logStep(
    `levels of detail: ${trianglesOf(exact)} triangles, ${away.triangles} in a browser, ` +
      `${coarse} at the coarsest level`,
  );
}

/** Checks that every file that the page offers comes, with the name that the server sends. */
async function checkDownloads({ page }) {
  await page.getByRole('button', { name: 'Download', exact: true }).click();
  const dialog = page.getByRole('dialog', { name: 'Download' });
  await dialog.waitFor();
  const names = await dialog
    .getByRole('radio')
    .evaluateAll((all) => all.map((input) => input.value));
  for (const name of ['STL', '3MF', 'GLB', 'PLY', 'OBJ', 'NC', 'APT', 'CSV', 'GLB compressed'])
    assert(names.includes(name), `no ${name}`);
  for (const name of names) {
    await dialog.locator(`[value="${name}"]`).check();
    const started = page.waitForEvent('download');
    await dialog.getByRole('button', { name: 'Download' }).click();
    const file = await started;
    assert.match(file.suggestedFilename(), /^end to end/, name);
    assert((await stat(await file.path())).size > 100, `${name} is empty`);
    await dialog.getByText('is in your downloads').waitFor();
  }
  await dialog.getByRole('button', { name: 'Close' }).click();
  logStep(`all ${names.length} files of the page come`);
}

async function checkExports(base, folder, session, wire) {
  const url = `${base}/v1/sessions/${SESSION}`;
  const model = await download(`${url}/model.glb`, join(options.out, 'model.glb'));
  const deltas = wire.glbs.length;
  assert(deltas > 2, `only ${deltas} mesh frames were received`);
  const errors = await gltfErrors(model, 'model.glb');
  for (const [i, glb] of wire.glbs.entries())
    errors.push(...(await gltfErrors(glb, `mesh frame ${i + 1}`)));
  assert.deepEqual(errors, []);
  await writeFile(join(options.out, 'delta.glb'), wire.glbs.at(-1));
  logStep(`model.glb and all ${deltas} mesh frames pass the glTF validator`);

  await download(`${url}/model.stl`, join(options.out, 'model.stl'));
  const stl = await stlFacts(join(options.out, 'model.stl'));
  assert(stl.facets > 100, `only ${stl.facets} facets`);
  assert.deepEqual(
    { ...stl, facets: 0 },
    { facets: 0, disconnected: 0, backwards: 0, degenerate: 0 },
  );
  logStep(`model.stl is closed: ${stl.facets} facets, none disconnected`);

  await download(`${url}/program.apt`, join(folder, 'program.apt'));
  await writeFile(join(folder, 'scene.json'), JSON.stringify(SCENE));
  await run(options.carve, [
    '--scene',
    join(folder, 'scene.json'),
    '--program',
    join(folder, 'program.apt'),
    '--report',
    join(folder, 'report.json'),
  ]);
  const report = JSON.parse(await readFile(join(folder, 'report.json'), 'utf8'));
  assert.equal(
    report.state_hash,
    session.state_hash,
    'kerf-carve of the exported APT program results in a different block',
  );
  logStep(`kerf-carve of the exported APT program results in the same state ${report.state_hash}`);
}

/**
 * Undo by the keyboard means the newest stroke; by the list of strokes all of them go and come back. One
 * alone may have cut nothing, where an agent was stopped.
 */
async function checkHistory({ page, state }, base, session) {
  await page.keyboard.press('Control+z');
  await until('undo of the newest stroke', SETTLE_S, async () => {
    const { strokes } = await getJson(`${base}/v1/sessions/${SESSION}/strokes`);
    return strokes.at(-1).undone;
  });
  await page.getByRole('button', { name: 'Show strokes' }).click();
  const list = page.getByRole('list', { name: 'Strokes' });
  await list.getByRole('button', { name: /^Redo/ }).waitFor();
  const pressEach = (name, isDone) =>
    until(`${name} of all strokes`, SETTLE_S, async () => {
      const button = list.getByRole('button', { name }).first();
      if ((await button.count()) > 0) await button.click({ timeout: 2000 });
      return isDone(await state());
    });
  await pressEach(/^Undo/, ({ removedVolumeMm3: mm3 }) => Math.abs(mm3) < 1e-6);
  await pressEach(/^Redo/, ({ hash }) => hash === session.state_hash);
  logStep('a page undid all strokes and redid them');
}

async function test(folder) {
  const { server, base } = await startServer(options, folder, SESSION, SCENE);
  assert.equal((await fetch(`${base}/healthz`)).status, 200);
  logStep(`server at ${base}, session ${SESSION} created from a scene`);
  await withBrowser(async (browser) => {
    const { viewers, wire } = await openViewers(base, browser);
    const live = await carve(base, folder, viewers);
    const session = await compare(base, viewers, wire);
    const still = await photograph(viewers[1], join(options.out, 'carved.png'));
    for (const variance of [live, still])
      assert(variance > 8, `the screenshot is blank: brightness varies by ${variance.toFixed(1)}`);
    logStep(
      `screenshots are not blank (brightness varies by ${live.toFixed(0)} and ` +
        `${still.toFixed(0)}): ${options.out}/carved.png`,
    );
    await compareDetail(viewers[0], wire);
    await checkDownloads(viewers[1]);
    await checkExports(base, folder, session, wire);
    await checkHistory(viewers[1], base, session);
    wire.close();
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
  logStep('the server stopped on SIGTERM');
}

await runTest(test, options.out);
