// SPDX-License-Identifier: Apache-2.0
// Benchmark of the page in headless Chromium with software WebGL: its start, the first tool, two
// hands, input in a block of four million dexels, and memory. See README.md.
//
// node page_bench.mjs --server PROGRAM --agent PROGRAM --web FOLDER [--minutes N] [--only PART]

import { loadavg } from 'node:os';
import { openViewer, withBrowser } from './support/browser.mjs';
import { METER, percentile, read, reset } from './support/meter.mjs';
import { start, stop, until } from './support/processes.mjs';
import { optionsOf, runTest, startServer } from './support/session.mjs';

const options = optionsOf(['server', 'agent', 'web'], {
  minutes: '1',
  only: '',
});

const SETTLE_S = 120;
const DESK = { width: 1440, height: 900 };
const STARTS = 7;
const TOOLS = [
  { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 },
  {
    id: 2,
    shape: 'flat',
    diameter_mm: 4,
    length_mm: 30,
    shank: { diameter_mm: 6, length_mm: 20 },
  },
];
const HANDS = {
  name: 'Two hands',
  stock: { shape: 'box', min_mm: [-30, -30, -20], max_mm: [30, 30, 0] },
  accuracy: {
    rays: 'dexel',
    pitch_mm: 0.25,
    tolerance_mm: 0.01,
    motion: 'tight',
  },
  tools: TOOLS,
  machine: { kinematics: 'tool-vector' },
};
const LARGE = {
  ...HANDS,
  name: 'Four million dexels',
  stock: { shape: 'box', min_mm: [-50, -50, -20], max_mm: [50, 50, 0] },
  accuracy: {
    rays: 'dexel',
    pitch_mm: 0.05,
    tolerance_mm: 0.01,
    motion: 'tight',
  },
  tools: [{ id: 1, shape: 'flat', diameter_mm: 12, length_mm: 30 }],
};

function print(what, value, wanted = '') {
  console.log(`${what.padEnd(64)} ${String(value).padStart(24)}  ${wanted}`);
}

const ms = (value) => `${value.toFixed(0)} ms`;
const pause = (seconds) => new Promise((resolve) => setTimeout(resolve, seconds * 1000));

/** Opens the page, and waits until it shows all of the block. */
async function open(browser, base, id) {
  const viewer = await openViewer(browser, `${base}/?session=${id}&name=Grace`, DESK, {
    script: METER,
  });
  await until('picture', SETTLE_S, async () => {
    const marks = await viewer.page.evaluate(() => window.kerf?.marks);
    return marks?.picture && (await viewer.state()).snapshotComplete;
  });
  return viewer;
}

async function startHand(base, viewer, id, name, tool) {
  const agent = start(options.agent, [
    ...['--server', base, '--session', id, '--device', 'sim', '--loop'],
    ...['--name', name, '--tool', String(tool)],
  ]);
  await until(`force of ${name}`, SETTLE_S, async () => {
    if (agent.code !== undefined) throw new Error(`the agent ended: ${agent.errors}`);
    const { participants } = await viewer.state();
    return participants.some((one) => one.name === name && one.forceSamples > 0);
  });
  return agent;
}

/** Loads the page several times: hello and first picture. */
async function measureStart(browser, base) {
  const all = [];
  for (let n = 0; n < STARTS; ++n) {
    const { page } = await open(browser, base, 'hands');
    all.push(await page.evaluate(() => ({ ...window.kerf.marks })));
    await page.context().close();
  }
  for (const [step, wanted] of [
    ['hello', '300 ms wanted'],
    ['welcome', ''],
    ['view', ''],
    ['picture', ''],
  ]) {
    const times = all.map((marks) => marks[step]);
    print(
      `${step} after the script's start: median, worst of ${STARTS}`,
      `${ms(percentile(times, 0.5))}, ${ms(Math.max(...times))}`,
      wanted,
    );
  }
}

/** What blocks the page when the first tool appears, then the pictures that it draws of two hands. */
async function measureHands(browser, base) {
  const viewer = await open(browser, base, 'hands');
  const { page } = viewer;
  await pause(4); // until what the start has left to do is done
  await reset(page);
  const hands = [await startHand(base, viewer, 'hands', 'Ada', 1)];
  await pause(5);
  const first = await read(page);
  print('longest task as the first tool appears', ms(Math.max(0, ...first.tasks)));
  print('longest time between two pictures then', ms(Math.max(0, ...first.gaps)));
  print('shader programs linked then', first.programs.length, 'none');
  print('longest wait for an answer about a shader program', ms(Math.max(0, ...first.waits)));
  hands.push(await startHand(base, viewer, 'hands', 'Linus', 2));
  await pause(3);
  await reset(page);
  const begin = Date.now();
  await pause(12);
  const { pictures, gaps } = await read(page);
  const seconds = (Date.now() - begin) / 1000;
  print('pictures a second of two hands', (pictures.length / seconds).toFixed(1), '10 wanted');
  print('between two of these pictures: p95', ms(percentile(gaps, 0.95)));
  for (const hand of hands) await stop(hand);
  await page.context().close();
}

/** A spiral that sinks, so that each tile under the tool changes all the time. */
function sinkingSpiral(seconds) {
  const lines = ['G21 G90', 'T1 M6', 'G0 X0 Y0 Z1', 'G1 Z0 F3000'];
  for (let n = 0; n < seconds * 20; ++n) {
    const [turn, radius] = [n * 0.25, 10 + n * 0.01];
    const at = [radius * Math.cos(turn), radius * Math.sin(turn), -0.01 * n];
    lines.push(`G1 X${at[0].toFixed(3)} Y${at[1].toFixed(3)} Z${at[2].toFixed(3)} F3000`);
  }
  return [...lines, 'M30', ''].join('\n');
}

/** Turns the camera by keys while a tool changes tiles of a large block. */
async function measureInput(browser, base) {
  const viewer = await open(browser, base, 'large');
  const { page, state } = viewer;
  const posted = await fetch(`${base}/v1/sessions/large/programs?dialect=linuxcnc&speed=1`, {
    method: 'POST',
    body: sinkingSpiral(60),
  });
  if (posted.status !== 202) throw new Error(await posted.text());
  const { id } = await posted.json();
  await pause(6);
  await page.locator('.canvas').focus();
  await reset(page);
  const [before, begin] = [await state(), Date.now()];
  for (let n = 0; n < 100; ++n) {
    await page.keyboard.press(n % 20 < 10 ? 'ArrowLeft' : 'ArrowRight');
    await pause(0.1);
  }
  const [after, seconds] = [await state(), (Date.now() - begin) / 1000];
  const { pictures, inputs, presented } = await read(page);
  const versions = ({ tiles }) => tiles.reduce((sum, { version }) => sum + version, 0);
  const tiles = versions(after) - versions(before);
  const frames = after.meshFrames - before.meshFrames;
  print(
    'tiles: of the block; changed in the page, a second',
    `${after.tiles.length}; ${(tiles / seconds).toFixed(0)}`,
  );
  print('mesh frames a second', (frames / seconds).toFixed(1), '20');
  print('pictures a second meanwhile', (pictures.length / seconds).toFixed(1));
  print('key to painted picture: p50', ms(percentile(inputs, 0.5)));
  print(
    `key to painted picture: p95 of ${inputs.length}`,
    ms(percentile(inputs, 0.95)),
    '100 ms wanted',
  );
  print(
    `key until presented, by the browser: p95 of ${presented.length}`,
    ms(percentile(presented, 0.95)),
  );
  await fetch(`${base}/v1/sessions/large/programs/${id}`, { method: 'DELETE' });
  await page.context().close();
}

/** Memory in use after a collection of garbage, and what the document has. */
async function memoryOf(tools) {
  await tools.send('HeapProfiler.collectGarbage');
  const { usedSize } = await tools.send('Runtime.getHeapUsage');
  const { nodes, jsEventListeners: listeners } = await tools.send('Memory.getDOMCounters');
  return { megabytes: usedSize / 1e6, nodes, listeners };
}

/** Memory of the page while two hands carve: a sample a minute, four at least. */
async function measureMemory(browser, base, minutes) {
  const viewer = await open(browser, base, 'hands');
  const { page } = viewer;
  const hands = [
    await startHand(base, viewer, 'hands', 'Ada', 1),
    await startHand(base, viewer, 'hands', 'Linus', 2),
  ];
  const tools = await page.context().newCDPSession(page);
  await pause(10);
  const steps = Math.max(3, Math.round(minutes));
  const samples = [await memoryOf(tools)];
  for (let n = 1; n <= steps; ++n) {
    await pause((minutes * 60) / steps);
    samples.push(await memoryOf(tools));
  }
  const heaps = samples.map(({ megabytes }) => megabytes);
  const [first, last] = [samples[0], samples.at(-1)];
  const shown = [heaps[0], Math.max(...heaps), heaps.at(-1)].map((value) => value.toFixed(2));
  print(`heap: at first, greatest, after ${minutes} minutes`, `${shown.join(', ')} MB`, 'flat');
  print('nodes of the document: at first, at the end', `${first.nodes}, ${last.nodes}`, 'flat');
  print('listeners: at first, at the end', `${first.listeners}, ${last.listeners}`, 'flat');
  for (const hand of hands) await stop(hand);
  await page.context().close();
}

async function bench(folder) {
  const { base } = await startServer(options, folder, 'hands', HANDS);
  const created = await fetch(`${base}/v1/sessions?id=large`, {
    method: 'POST',
    body: JSON.stringify(LARGE),
  });
  if (created.status !== 201) throw new Error(await created.text());
  await withBrowser(async (browser) => {
    const parts = {
      start: () => measureStart(browser, base),
      hands: () => measureHands(browser, base),
      input: () => measureInput(browser, base),
      memory: () => measureMemory(browser, base, Number(options.minutes)),
    };
    console.log(`load average ${loadavg()[0].toFixed(1)}`);
    for (const [name, measure] of Object.entries(parts))
      if (!options.only || options.only === name) await measure();
    console.log(`load average ${loadavg()[0].toFixed(1)}`);
  });
}

await runTest(bench);
