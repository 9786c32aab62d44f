// SPDX-License-Identifier: Apache-2.0
// Carves blocks with kerf.wasm, as a page does, and with the same functions compiled for this
// machine: every answer, state and mesh must be equal to the last bit.
//
// node page_bytes.mjs page_job kerf.wasm FOLDER; exit status 77 if there is no kerf.wasm

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { everyTile, frame, jobFile, motion, openKernel, stock, welcome } from './page_frames.mjs';

const [, , program, file, folder] = process.argv;
const GZIP_MAX = 350_000;
const BOX = [
  [-20, -15, -10],
  [20, 15, 0],
];
const TILES = [3, 2, 1];
const TOOLS = [
  { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 },
  { id: 2, shape: 'taper', diameter_mm: 2, half_angle_deg: 8, length_mm: 30 },
];

/** Knuth's generator: the same job on every machine. */
let state = 7n;
function random(low, high) {
  state = BigInt.asUintN(64, state * 6364136223846793005n + 1442695040888963407n);
  return low + ((high - low) * Number(state >> 44n)) / 2 ** 20;
}

/** A path of small steps: samples of a tool that leans more and more. */
class Hand {
  sequence = 0n;
  tip = [-10, -8, -1];
  lean = [0, 0];

  motion(tool, turns) {
    return motion(Array.from({ length: 16 }, () => this.sample_(tool, turns)));
  }

  sample_(tool, turns) {
    const limits = [18, 13, 3];
    this.tip = this.tip.map((value, n) => {
      const next = value + random(-0.6, n === 0 ? 0.9 : 0.62);
      return n === 2
        ? Math.max(-4, Math.min(0, next))
        : Math.max(-limits[n], Math.min(limits[n], next));
    });
    if (turns) this.lean = this.lean.map((value) => value * 0.98 + random(-0.03, 0.03));
    const [u, v] = this.lean;
    const length = Math.hypot(u, v, 1);
    this.sequence += 1n;
    const axis = [u / length, v / length, 1 / length];
    return { sequence: this.sequence, tip: this.tip, axis, tool };
  }
}

/** [kind, bytes] of the inputs of the functions: a welcome, frames, undo, redo and settle. */
function job(rays) {
  const hand = new Hand();
  const sent = [['w', welcome(rays, 0.5, BOX, TOOLS)]];
  const send = (bytes) => sent.push(['f', bytes]);
  const ask = (kind) => sent.push([kind, Buffer.alloc(0)]);
  send(hand.motion(1, false)); // before anything is known
  send(
    stock(
      1,
      5000n,
      everyTile(rays, TILES).map((at) => [...at, null]),
    ),
  );
  for (let n = 0; n < 8; ++n) send(hand.motion(n % 2 === 0 ? 1 : 2, n > 3));
  send(stock(0, 20_000n, [[2, 1, 0, 30_000]])); // another participant has cut a tile flat
  for (let n = 0; n < 3; ++n) send(hand.motion(1, true));
  ask('u');
  ask('r');
  ask('u');
  send(hand.motion(2, true));
  ask('s');
  send(
    stock(2, 60_000n, [
      [2, 1, 0, 50_000],
      [2, 0, 1, null],
    ]),
  ); // an undo
  for (let n = 0; n < 3; ++n) send(hand.motion(2, true));
  send(Buffer.from('no frame'));
  return sent;
}

function fnv(bytes) {
  let hash = 0x811c9dc5;
  for (const byte of bytes) hash = Math.imul(hash ^ byte, 0x01000193);
  return (hash >>> 0).toString(16).padStart(8, '0');
}

async function runWasm(sent) {
  const { calls, put, output } = await openKernel(readFileSync(file));
  const lines = [];
  for (const [kind, bytes] of sent) {
    put(bytes);
    if (kind === 'w') {
      lines.push(`open ${calls.kerf_open()}`);
      continue;
    }
    if (kind === 'f') {
      const taken = calls.kerf_take();
      const hash = BigInt.asUintN(64, calls.kerf_hash()).toString(16).padStart(16, '0');
      lines.push(`take ${taken} ${hash}`);
    } else if (kind === 's') {
      calls.kerf_settle();
    } else {
      calls.kerf_change(kind === 'u');
    }
    const count = calls.kerf_changed();
    const tiles = new Int32Array(output(12 * count).buffer);
    for (let n = 0; n < count; ++n) {
      const [x, y, byPage] = tiles.subarray(3 * n);
      const vertices = calls.kerf_mesh(x, y);
      const [indices] = new Uint32Array(output(4).buffer);
      const mesh = output(4 + 25 * vertices + 4 * indices);
      lines.push(`tile ${x} ${y} ${byPage}: ${vertices} ${fnv(mesh)}`);
    }
  }
  return lines;
}

if (!existsSync(file)) {
  console.log(`skipped: there is no ${file} (web/wasm/README.md)`);
  process.exit(77);
}
const { gzipSync } = await import('node:zlib');
const size = gzipSync(readFileSync(file), { level: 9 }).length;
console.log(`kerf.wasm: ${size} bytes with gzip`);
mkdirSync(folder, { recursive: true });
for (const rays of ['dexel', 'tri-dexel']) {
  const sent = job(rays);
  const path = join(folder, `${rays}.job`);
  writeFileSync(path, jobFile(sent));
  const expected = execFileSync(program, [path], { encoding: 'utf8' }).trimEnd().split('\n');
  const seen = await runWasm(sent);
  assert.deepEqual(seen, expected, `${rays}: kerf.wasm differs from this machine's kernel`);
  const states = new Set(expected.filter((line) => line.startsWith('take 1')));
  const meshes = expected.filter((line) => line.startsWith('tile'));
  assert(expected[0] === 'open 0' && states.size > 12 && meshes.length > 20, expected.join('\n'));
  assert(expected.at(-1).startsWith('take 0'), 'a malformed frame is taken');
  console.log(`${rays}: ${states.size} states and ${meshes.length} meshes are equal`);
}
assert(size <= GZIP_MAX, `kerf.wasm has ${size} bytes with gzip; the limit is ${GZIP_MAX}`);
