// SPDX-License-Identifier: Apache-2.0
// Carves blocks with kerf.wasm, as a page does, and with the same functions compiled for this
// machine: every answer, state and mesh must be equal to the last bit.
//
// node page_bytes.mjs page_job kerf.wasm FOLDER; exit status 77: there is no kerf.wasm

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [, , program, file, folder] = process.argv;
const GZIP_MAX = 350_000;
const TILES = [3, 2];
const TOOLS = [
  { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 },
  { id: 2, shape: 'taper', diameter_mm: 2, half_angle_deg: 8, length_mm: 30 },
];

function welcome(rays) {
  return JSON.stringify({
    type: 'welcome',
    stock: { shape: 'box', min_mm: [-20, -15, -10], max_mm: [20, 15, 0] },
    accuracy: { rays, pitch_mm: 0.5, tolerance_mm: 0.01, motion: 'tight' },
    tools: TOOLS,
    force: { law: 'specific_energy', specific_force_n_per_mm2: 0.5, drr_n_s_per_mm3: 0.01 },
    limits: { speed_mm_per_s: 5000 },
  });
}

/** Knuth's generator: the same job on every machine. */
let state = 7n;
function random(low, high) {
  state = BigInt.asUintN(64, state * 6364136223846793005n + 1442695040888963407n);
  return low + ((high - low) * Number(state >> 44n)) / 2 ** 20;
}

function frame(type, flags, payload) {
  const header = Buffer.alloc(32);
  header.write('KRF1', 0);
  header.writeUInt8(type, 4);
  header.writeUInt8(flags, 5);
  header.writeUInt16LE(32, 6);
  header.writeUInt32LE(payload.length, 8);
  header.writeUInt32LE(1, 12);
  return Buffer.concat([header, payload]);
}

/** A path of small steps: samples of a tool that leans more and more. */
class Hand {
  sequence = 0n;
  tip = [-10, -8, -1];
  lean = [0, 0];

  motion(tool, turns) {
    const payload = Buffer.alloc(8 + 16 * 64);
    payload.writeUInt32LE(16, 0);
    for (let n = 0; n < 16; ++n) this.sample_(payload, 8 + 64 * n, tool, turns);
    return frame(1, 0, payload);
  }

  sample_(to, at, tool, turns) {
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
    to.writeBigUInt64LE(this.sequence, at);
    to.writeBigUInt64LE(this.sequence * 1000n, at + 8);
    this.tip.forEach((value, n) => to.writeDoubleLE(value, at + 16 + 8 * n));
    [u / length, v / length, 1 / length].forEach((value, n) =>
      to.writeFloatLE(value, at + 40 + 4 * n),
    );
    to.writeUInt32LE(tool, at + 52);
    to.writeUInt32LE(1, at + 56);
  }
}

/** Tiles of stock; `top`: the quanta that are left in each column, null: no change. */
function stock(flags, timeUs, tiles) {
  const parts = [Buffer.alloc(16)];
  parts[0].writeBigUInt64LE(timeUs, 0);
  parts[0].writeUInt32LE(tiles.length, 8);
  for (const [axis, x, y, top] of tiles) {
    const columns =
      top === null ? [] : [(1 << 2) | 1, ...leb(0), ...leb(2 * top), ...leb((1023 << 2) | 2)];
    const head = Buffer.alloc(16);
    [axis, x, y, columns.length].forEach((value, n) => head.writeUInt32LE(value, 4 * n));
    parts.push(head, Buffer.from(columns));
  }
  return frame(8, flags, Buffer.concat(parts));
}

function leb(value) {
  const bytes = [];
  for (; value >= 0x80; value = Math.floor(value / 128)) bytes.push((value % 128) | 0x80);
  return [...bytes, value];
}

function* everyTile(rays) {
  for (const axis of rays === 'dexel' ? [2] : [2, 0, 1])
    for (let y = 0; y < 3; ++y) for (let x = 0; x < 3; ++x) yield [axis, x, y];
}

function tilesOf(rays) {
  const sides = { 2: TILES, 0: [2, 1], 1: [1, 3] };
  return [...everyTile(rays)].filter(([axis, x, y]) => x < sides[axis][0] && y < sides[axis][1]);
}

/** [kind, bytes] of what the functions get: a welcome, frames, undo, redo and settle. */
function job(rays) {
  const hand = new Hand();
  const sent = [['w', Buffer.from(welcome(rays))]];
  const send = (bytes) => sent.push(['f', bytes]);
  const ask = (kind) => sent.push([kind, Buffer.alloc(0)]);
  send(hand.motion(1, false)); // before anything is known
  send(
    stock(
      1,
      5000n,
      tilesOf(rays).map((at) => [...at, null]),
    ),
  );
  for (let n = 0; n < 8; ++n) send(hand.motion(n % 2 === 0 ? 1 : 2, n > 3));
  send(stock(0, 20_000n, [[2, 1, 0, 30_000]])); // another has cut a tile flat
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
  const module = await WebAssembly.compile(readFileSync(file));
  const system = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module))
    (system[from] ??= {})[name] = () => 8;
  const { exports: calls } = await WebAssembly.instantiate(module, system);
  calls._initialize();
  const output = (bytes) => new Uint8Array(calls.memory.buffer, calls.kerf_output(), bytes).slice();
  const lines = [];
  for (const [kind, bytes] of sent) {
    const at = calls.kerf_input(bytes.length);
    new Uint8Array(calls.memory.buffer, at, bytes.length).set(bytes);
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
  const parts = sent.map(([kind, bytes]) => {
    const head = Buffer.alloc(5);
    head.write(kind, 0);
    head.writeUInt32LE(bytes.length, 1);
    return Buffer.concat([head, bytes]);
  });
  writeFileSync(path, Buffer.concat(parts));
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
