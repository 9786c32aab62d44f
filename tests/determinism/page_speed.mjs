// SPDX-License-Identifier: Apache-2.0
// Measures how fast kerf.wasm carves and displays strokes, compared with the same functions
// compiled for this machine: tools of 10 mm, upright and turning, 2 mm deep in fresh stock at
// 0.1 mm, in frames of 1 mm with 8 samples. Each carves a block, and then a second, equal one: by
// then node has optimized the functions of kerf.wasm, and both have allocated their memory.
//
// node page_speed.mjs page_job kerf.wasm FOLDER [TOOL]

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { everyTile, jobFile, motion, openKernel, stock, welcome } from './page_frames.mjs';

const [, , program, file, folder, only] = process.argv;
const BOX = [
  [0, 0, -20],
  [60, 60, 0],
];
const TILES = [19, 19, 7];
const SIZE = { id: 1, diameter_mm: 10, length_mm: 30 };
const TOOLS = {
  ball: { ...SIZE, shape: 'ball' },
  flat: { ...SIZE, shape: 'flat' },
  'bull nose': { ...SIZE, shape: 'bull_nose', corner_radius_mm: 2 },
  cone: { ...SIZE, shape: 'cone_end', tip_angle_deg: 90 },
};
const LEAN_RAD = 0.3; // of a tool that turns, to both sides along a groove
const SAMPLES = 8;
const LINES = [12, 20, 28, 36, 44];
const FROM_MM = 10;
const TO_MM = 50;
const ROUNDS = 5;

/**
 * Parallel grooves, twice. 'c': a frame is carved. 'd': the changed tiles are meshed, the first
 * time.
 */
function job(rays, tool, turns) {
  const first = grooves(rays, tool, turns);
  return [...first, ...first.filter(([kind]) => kind !== 'd')];
}

function grooves(rays, tool, turns) {
  const tiles = everyTile(rays, TILES).map((at) => [...at, null]);
  const sent = [
    ['w', welcome(rays, 0.1, BOX, [tool])],
    ['f', stock(1, 0n, tiles)],
  ];
  let sequence = 0n;
  const sample = (x, y, z) => {
    const lean = turns ? LEAN_RAD * Math.sin((x - FROM_MM) / 5) : 0;
    const axis = [Math.sin(lean), 0, Math.cos(lean)];
    return { sequence: ++sequence, tip: [x, y, z], axis, tool: 1 };
  };
  for (const y of LINES) {
    for (let z = 2; z > -2; z -= 1) sent.push(['c', motion([sample(FROM_MM, y, z)])]);
    sent.push(['d', Buffer.alloc(0)]);
    for (let x = FROM_MM; x < TO_MM; ++x) {
      const steps = Array.from({ length: SAMPLES }, (_, n) => sample(x + (n + 1) / SAMPLES, y, -2));
      sent.push(['c', motion(steps)], ['d', Buffer.alloc(0)]);
    }
    for (let z = -2; z < 2; z += 1) sent.push(['c', motion([sample(TO_MM, y, z)])]);
    sequence += 1000n;
  }
  return sent;
}

async function timeWasm(sent) {
  const { calls, put, output } = await openKernel(readFileSync(file));
  const times = [];
  for (const [kind, bytes] of sent) {
    const begin = performance.now();
    if (kind === 'd') {
      const tiles = new Int32Array(output(12 * calls.kerf_changed()).buffer);
      for (let n = 0; n < tiles.length; n += 3) calls.kerf_mesh(tiles[n], tiles[n + 1]);
      times.at(-1).displayed += performance.now() - begin;
      continue;
    }
    put(bytes);
    if (kind === 'w') {
      assert.equal(calls.kerf_open(), 0);
      times.push({ carved: 0, displayed: 0 });
      continue;
    }
    assert.equal(calls.kerf_take(), 1);
    if (kind === 'c') times.at(-1).carved += performance.now() - begin;
  }
  return figuresOf(times);
}

const figuresOf = ([first, again]) => [first.carved, again.carved, first.displayed];

function timeNative(path) {
  const lines = execFileSync(program, [path], { encoding: 'utf8' }).trimEnd().split('\n');
  const times = lines.filter((line) => line.startsWith('time '));
  return figuresOf(
    times.map((line) => {
      const [carved, displayed] = line.split(' ').slice(1).map(Number);
      return { carved, displayed };
    }),
  );
}

const WHAT = ['carved', 'carved again', 'displayed'];

/** The least times of a kind of work, natively and by kerf.wasm. */
async function measure(sent, path) {
  writeFileSync(path, jobFile(sent));
  const least = { native: WHAT.map(() => Infinity), page: WHAT.map(() => Infinity) };
  for (let round = 0; round < ROUNDS; ++round) {
    const [native, page] = [timeNative(path), await timeWasm(sent)];
    for (const n of WHAT.keys()) {
      least.native[n] = Math.min(least.native[n], native[n]);
      least.page[n] = Math.min(least.page[n], page[n]);
    }
  }
  return least;
}

mkdirSync(folder, { recursive: true });
const length = LINES.length * (TO_MM - FROM_MM);
for (const rays of ['dexel', 'tri-dexel']) {
  for (const [name, tool] of Object.entries(TOOLS)) {
    if (only && only !== name) continue;
    for (const turns of [false, true]) {
      const least = await measure(job(rays, tool, turns), join(folder, 'speed.job'));
      for (const [n, what] of WHAT.entries()) {
        const [native, page] = [least.native[n] / length, least.page[n] / length];
        console.log(
          `${rays}, ${name}${turns ? ' that turns' : ''}, 1 mm ${what}: ${native.toFixed(2)} ms ` +
            `natively, ${page.toFixed(2)} ms by kerf.wasm, ${(page / native).toFixed(2)} times`,
        );
      }
    }
  }
}
