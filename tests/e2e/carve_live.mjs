// SPDX-License-Identifier: Apache-2.0
// The whole line, end to end: the real server, two agents at 1 kHz on one block, two browsers and a viewer without a browser.
// At the end all of them must have the same block, and what can be taken home must be sound. See README.md.
//
// node carve_live.mjs --server PROGRAM --agent PROGRAM --carve PROGRAM --web FOLDER --out FOLDER [--seconds N]

import assert from 'node:assert/strict';
import { mkdir, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { parseArgs } from 'node:util';
import { launchBrowser, openViewer, photograph } from './support/browser.mjs';
import { gltfComplaints, stlFacts, tilesOf } from './support/checks.mjs';
import { run, start, stop, stopAll, until } from './support/processes.mjs';
import { WireViewer } from './support/wire_viewer.mjs';

const { values: options } = parseArgs({
  options: {
    server: { type: 'string' }, agent: { type: 'string' }, carve: { type: 'string' }, web: { type: 'string' },
    out: { type: 'string' }, seconds: { type: 'string', default: '5' },
  },
});
for (const name of ['server', 'agent', 'carve', 'web', 'out']) assert(options[name], `--${name} is missing`);

const SESSION = 'e2e';
const SETTLE_S = 90; // software WebGL on a busy machine
const SCENE = {
  name: 'end to end',
  stock: { shape: 'box', min_mm: [-30, -30, -20], max_mm: [30, 30, 0] },
  accuracy: { rays: 'dexel', pitch_mm: 0.5, tolerance_mm: 0.01, motion: 'tight' },
  tools: [
    { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 },
    { id: 2, shape: 'flat', diameter_mm: 4, length_mm: 30 },
  ],
  machine: { kinematics: 'tool-vector' }, // hands tilt their tools
};

let step = 0;
function say(text) {
  console.log(`${String(++step).padStart(2)}  ${text}`);
}

async function getJson(url) {
  const response = await fetch(url);
  assert.equal(response.status, 200, `${url} answered ${response.status}`);
  return response.json();
}

async function download(url, file) {
  const response = await fetch(url);
  assert.equal(response.status, 200, `${url} answered ${response.status}`);
  const bytes = Buffer.from(await response.arrayBuffer());
  await writeFile(file, bytes);
  return bytes;
}

async function startServer(folder) {
  const server = start(options.server, ['--listen', '127.0.0.1:0', '--data', join(folder, 'data'), '--web', options.web]);
  const base = await until('address of the server', 20, () => {
    assert.equal(server.code, undefined, `the server ended: ${server.errors}`);
    return server.lines.find((line) => line.startsWith('http'));
  });
  assert.equal((await fetch(`${base}/healthz`)).status, 200);
  const created = await fetch(`${base}/v1/sessions?id=${SESSION}`, { method: 'POST', body: JSON.stringify(SCENE) });
  assert.equal(created.status, 201, await created.text());
  say(`server at ${base}, session ${SESSION} created from a scene`);
  return { server, base };
}

async function openViewers(base, browser) {
  const viewers = await Promise.all(['Grace', 'Mary'].map((name) =>
    openViewer(browser, `${base}/?session=${SESSION}&name=${name}`, { width: 900, height: 560 })));
  const wire = new WireViewer(base, SESSION);
  for (const { state } of viewers) await until('whole block in a browser', SETTLE_S, async () => (await state())?.snapshotComplete);
  await until('whole block on the wire', SETTLE_S, () => wire.snapshotComplete);
  say('two browsers and a wire viewer show the block');
  return { viewers, wire };
}

function startAgent(base, folder, name, tool, color) {
  return start(options.agent, [
    '--server', base, '--session', SESSION, '--device', 'sim', '--duration', options.seconds, '--name', name, '--color', color,
    '--tool', String(tool), '--status-json', join(folder, `${name}.json`),
  ]);
}

/** Both agents carve; a picture is taken while they do. */
async function carve(base, folder, viewers) {
  const agents = [startAgent(base, folder, 'Ada', 1, '#c2410c'), startAgent(base, folder, 'Linus', 2, '#0f766e')];
  const seen = await until('both tools in a browser, and a force', SETTLE_S, async () => {
    const { participants } = await viewers[0].state();
    const carvers = participants.filter(({ kind }) => kind === 'agent');
    return carvers.length === 2 && carvers.every(({ forceSamples }) => forceSamples > 0)
      && carvers.some(({ peakForceN }) => peakForceN > 0) && carvers;
  });
  assert.deepEqual(seen.map(({ name, color }) => `${name} ${color}`).sort(), ['Ada #c2410c', 'Linus #0f766e']);
  const variance = await photograph(viewers[0], join(options.out, 'carving.png'));
  for (const agent of agents) assert.equal(await agent.ended, 0, `${agent.name}: ${agent.errors}${agent.lines.join('\n')}`);
  say(`two agents carved at 1 kHz for ${options.seconds} s; a browser saw both tools and their forces`);
  return variance;
}

/** Waits until everybody says that they have all of the server's newest state, and compares. */
async function compare(base, viewers, wire) {
  const session = await getJson(`${base}/v1/sessions/${SESSION}`);
  assert(session.motions > 1000, `only ${session.motions} motions arrived`);
  assert(session.removed_volume_mm3 > 1, `only ${session.removed_volume_mm3} mm³ were removed`);
  const settled = (state) => state?.settled && (state.hash ?? state.state_hash) === session.state_hash;
  const states = [];
  for (const viewer of viewers) states.push(await until('settled browser', SETTLE_S, async () => {
    const state = await viewer.state();
    return settled(state) && state;
  }));
  await until('settled wire viewer', SETTLE_S, () => settled(wire.state));
  const [first, second] = states;
  const versions = ({ tiles }) => tiles.map(({ x, y, version }) => [x, y, version]);
  assert.deepEqual(versions(first), versions(second), 'the browsers show different tiles');
  assert.equal(first.motions, session.motions);
  for (const state of states) assert.equal(state.problems, 0, state.problem);
  for (const { problems } of viewers) assert.deepEqual(problems, []);
  assert.deepEqual(wire.errors, []);
  say(`server, browsers and wire agree: state ${session.state_hash}, ${session.motions} motions, ${first.triangles} triangles`);
  return session;
}

/** What a viewer of mesh frames has in the end: the newest of each tile. */
function shown(wire) {
  return [...new Map(wire.glbs.flatMap(tilesOf).map((tile) => [tile.tile, tile])).values()];
}

function trianglesOf(tiles) {
  return tiles.reduce((sum, { triangles }) => sum + triangles, 0);
}

/** Who looks from afar gets coarser tiles, and exact ones again when coming near; a browser asks for them by itself. */
async function compareDetail(viewer, wire) {
  const exact = shown(wire);
  assert(exact.every(({ level }) => level === 0), 'a viewer that said nothing got coarse tiles');
  const away = await until('coarse tiles in a browser', SETTLE_S, async () => {
    const state = await viewer.state();
    return state.tiles.every(({ level }) => level > 0) && state;
  });
  assert(2 * away.triangles < trianglesOf(exact), `${away.triangles} of ${trianglesOf(exact)} triangles`);
  await viewer.page.locator('.canvas').focus();
  for (let i = 0; i < 12; ++i) await viewer.page.keyboard.press('+');
  const near = await until('exact tiles in a browser that came near', SETTLE_S, async () => {
    const state = await viewer.state();
    return state.tiles.some(({ level }) => level === 0) && state;
  });
  assert(near.triangles > away.triangles);
  assert.equal(near.problems, 0, near.problem);

  wire.look([0, 0, 5000], 0.01);
  await until('the coarsest tiles on the wire', SETTLE_S, () => shown(wire).every(({ level }) => level === 3));
  const coarse = trianglesOf(shown(wire));
  assert(5 * coarse < trianglesOf(exact), `${coarse} of ${trianglesOf(exact)} triangles`);
  wire.look([0, 0, 5000], 0);
  await until('exact tiles on the wire', SETTLE_S, () => shown(wire).every(({ level }) => level === 0));
  assert.deepEqual(shown(wire), exact);
  say(`levels of detail: ${trianglesOf(exact)} triangles, ${away.triangles} in a browser, ${coarse} from afar, and back`);
}

/** Every download of the page works, and has the name that the server gave it. */
async function pressButtons(viewer) {
  const links = await viewer.page.locator('a.download, a.variant').evaluateAll((all) => all.map((a) => [a.textContent, a.href]));
  const names = links.map(([name]) => name);
  for (const name of ['STL', '3MF', 'GLB', 'PLY', 'OBJ', 'NC', 'APT', 'CSV', 'GLB compressed']) assert(names.includes(name), `no ${name}`);
  for (const [name, url] of links) {
    const response = await fetch(url);
    assert.equal(response.status, 200, `${name}: ${url} answered ${response.status}`);
    assert((await response.arrayBuffer()).byteLength > 100, `${name} is empty`);
    assert.match(response.headers.get('content-disposition'), /filename="end to end/);
  }
  const coming = viewer.page.waitForEvent('download');
  await viewer.page.getByRole('link', { name: '3MF' }).click();
  assert.equal((await coming).suggestedFilename(), 'end to end.3mf');
  say(`all ${links.length} downloads of the page work`);
}

async function takeHome(base, folder, session, wire) {
  const url = `${base}/v1/sessions/${SESSION}`;
  const model = await download(`${url}/model.glb`, join(options.out, 'model.glb'));
  const deltas = wire.glbs.length;
  assert(deltas > 2, `only ${deltas} mesh frames came`);
  const complaints = await gltfComplaints(model, 'model.glb');
  for (const [i, glb] of wire.glbs.entries()) complaints.push(...await gltfComplaints(glb, `mesh frame ${i + 1}`));
  assert.deepEqual(complaints, []);
  await writeFile(join(options.out, 'delta.glb'), wire.glbs.at(-1));
  say(`model.glb and all ${deltas} mesh frames pass the glTF validator`);

  await download(`${url}/model.stl`, join(options.out, 'model.stl'));
  const stl = await stlFacts(join(options.out, 'model.stl'));
  assert(stl.facets > 100, `only ${stl.facets} facets`);
  assert.deepEqual({ ...stl, facets: 0 }, { facets: 0, disconnected: 0, backwards: 0, degenerate: 0 });
  say(`model.stl is closed: ${stl.facets} facets, none disconnected`);

  await download(`${url}/program.apt`, join(folder, 'program.apt'));
  await writeFile(join(folder, 'scene.json'), JSON.stringify(SCENE));
  await run(options.carve, [
    '--scene', join(folder, 'scene.json'), '--program', join(folder, 'program.apt'), '--report', join(folder, 'report.json')]);
  const report = JSON.parse(await readFile(join(folder, 'report.json'), 'utf8'));
  assert.equal(report.state_hash, session.state_hash, 'the re-carved APT program gives another block');
  say(`kerf-carve of the exported APT program gives the same state ${report.state_hash}`);
}

async function test(folder) {
  const { server, base } = await startServer(folder);
  const browser = await launchBrowser();
  try {
    const { viewers, wire } = await openViewers(base, browser);
    const live = await carve(base, folder, viewers);
    const session = await compare(base, viewers, wire);
    const still = await photograph(viewers[1], join(options.out, 'carved.png'));
    for (const variance of [live, still]) assert(variance > 8, `the picture is blank: brightness varies by ${variance.toFixed(1)}`);
    say(`pictures are not blank (brightness varies by ${live.toFixed(0)} and ${still.toFixed(0)}): ${options.out}/carved.png`);
    await compareDetail(viewers[0], wire);
    await pressButtons(viewers[1]);
    await takeHome(base, folder, session, wire);
    wire.close();
  } finally {
    await browser.close();
  }
  assert.equal(await stop(server), 0, `the server did not end well: ${server.errors}`);
  say('the server ended when asked to');
}

await mkdir(options.out, { recursive: true });
const folder = await mkdtemp(join(tmpdir(), 'kerf-e2e-'));
try {
  await test(folder);
  console.log('ok');
} catch (problem) {
  console.error(problem);
  process.exitCode = 1;
} finally {
  await stopAll();
  await rm(folder, { recursive: true, force: true });
}
