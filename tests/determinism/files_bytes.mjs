// SPDX-License-Identifier: Apache-2.0
// Carves programs with kerf_files.wasm, as kerf.html does, and with kerf-carve. State hash, STL
// file, errors and the scene derived from a program must be equal to the last byte.
//
// node --no-warnings --no-turbo-fast-api-calls files_bytes.mjs kerf-carve kerf_files.wasm FOLDER
// exit status 77 if there is no kerf_files.wasm
// With further arguments PROGRAM [SCENE] it compares, and times, that program only.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';
import { WASI } from 'node:wasi';
import { gzipSync, inflateRawSync } from 'node:zlib';

const [, , program, file, folder, ...given] = process.argv;
const carve = resolve(program);

function scene(rays, tools, machine = {}) {
  return JSON.stringify({
    name: 'job',
    stock: { shape: 'box', min_mm: [-20, -15, -12], max_mm: [20, 15, 0] },
    accuracy: { rays, pitch_mm: 0.5, tolerance_mm: 0.01 },
    tools,
    machine,
  });
}

const TOOLS = [
  { id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 },
  { id: 2, shape: 'bull_nose', diameter_mm: 8, corner_radius_mm: 1, length_mm: 30 },
];

/** The standard job, a raster, with both tools. With `lean` the axis swings. */
function raster(rows, lean) {
  const lines = ['G21 G90', 'T1 M6', 'F1000'];
  for (let row = 0; row < rows; ++row) {
    if (row === rows / 2) lines.push('T2 M6');
    const y = -14 + (28 / rows) * row;
    lines.push(`G0 X-22 Y${y.toFixed(3)} Z5`, 'G1 Z-3');
    for (let x = -21; x <= 22; x += 3) {
      const angle = lean ? 20 * Math.sin(0.3 * x + row) : 0;
      const axis = lean ? ` A${angle.toFixed(4)} C${(3 * x).toFixed(4)}` : '';
      lines.push(`G1 X${x} Y${y.toFixed(3)} Z${(-3 - 0.05 * row).toFixed(3)}${axis}`);
    }
    lines.push('G0 Z5');
  }
  return [...lines, 'M30', ''].join('\n');
}

const ARCS = `(T5 D=4. CR=2. - ball end mill)
G21 G90 G17
T5 M6
G0 X0 Y0 Z5
G1 Z-1 F300
G2 X20 Y0 I10 J0
G3 X40 Y10 R15
#1 = 3
O100 while [#1 LT 12]
G2 X[20+#1] Y[2*SIN[10*#1]] Z[-#1/5] R30
#1 = [#1 + 1]
O100 endwhile
G0 Z5
M30
`;
const KLARTEXT = `0 BEGIN PGM T MM
1 BLK FORM 0.1 Z X+0 Y+0 Z-10
2 BLK FORM 0.2 X+60 Y+40 Z+0
3 TOOL CALL 1 Z S3000 ; D=10
4 L X-10 Y+20 Z+5 R0 FMAX
5 L Z-3 F300
6 L X+30
7 CC X+30 Y+30
8 C X+40 Y+30 DR+
9 L Z+50 FMAX M30
10 END PGM T MM
`;
const APT = `PARTNO A
UNITS/MM
MULTAX
LOADTL/1
FEDRAT/500
FROM/0,0,20,0,0,1
RAPID
GOTO/-25,0,-2,0,0,1
GOTO/25,0,-2,0.1,0,0.995
FINI
`;

/** A box as ASCII STL. */
function box() {
  const corner = (n) => [n & 1 ? 8 : -8, n & 2 ? 8 : -8, n & 4 ? 0 : -9].join(' ');
  const sides = ['023 031', '457 476', '015 054', '273 267', '046 062', '137 175'];
  const facet = (side) => {
    const corners = [...side].map((n) => `vertex ${corner(Number(n))}`);
    return `facet normal 0 0 0\nouter loop\n${corners.join('\n')}\nendloop\nendfacet`;
  };
  return `solid p\n${sides.join(' ').split(' ').map(facet).join('\n')}\nendsolid p\n`;
}

/** Name, files, and the names of program, scene and stock among them. */
const JOBS = [
  [
    'three axes',
    { 'a.ngc': raster(24, false), 's.json': scene('dexel', TOOLS) },
    ['a.ngc', 's.json'],
  ],
  [
    'five axes, three fields',
    {
      'b.ngc': raster(6, true),
      's.json': scene('tri-dexel', TOOLS, { kinematics: 'xyzac-trt' }),
    },
    ['b.ngc', 's.json'],
  ],
  ['arcs, loops and a comment', { 'c.nc': ARCS }, ['c.nc']],
  [
    'a wall that a target keeps by a finer pitch',
    {
      'w.ngc':
        'G21 G90\nT1 M6\nF500\nG0 X-12 Y-2 Z5\nG1 Z-2\nG1 X12\nG1 Y2.25\nG1 X-12\nG0 Z5\nM30\n',
      's.json': JSON.stringify({
        name: 'wall',
        stock: { shape: 'box', min_mm: [-10, -6, -4], max_mm: [10, 6, 0] },
        accuracy: { target_mm: 0.4 },
        tools: [{ id: 1, shape: 'flat', diameter_mm: 4, length_mm: 10 }],
      }),
    },
    ['w.ngc', 's.json'],
  ],
  ['Klartext', { 'd.h': KLARTEXT }, ['d.h']],
  ['APT', { 'e.apt': APT }, ['e.apt']],
  [
    'a model as stock, a subroutine beside',
    {
      'f.ngc':
        '(T1 D=9.)\nG21 G90\nT1 M6\nG0 X-30 Y0 Z5\nG1 Z-2 F500\nO<across> call\nG0 Z9\nM30\n',
      'across.ngc': 'O<across> sub\nG1 X30 Y4\nG1 X-30 Y-3\nO<across> endsub\n',
      'p.stl': box(),
    },
    ['f.ngc', '', 'p.stl'],
  ],
];

/** Programs that must be rejected where `kerf-carve` rejects them, with the same message. */
const FAULTS = [
  ['a word', { 'g.ngc': 'G21 G90\nG1 X5 F100\nG1 X7 Q3\nM30\n' }, ['g.ngc']],
  ['a call', { 'h.ngc': 'G21\nG1 X5 F100\nO<nowhere> call\nM30\n' }, ['h.ngc']],
  ['a name', { 'i.docx': 'G21\n' }, ['i.docx']],
  ['a scene', { 'j.ngc': 'G21\n', 's.json': '{"name": "x", "stock": 3}' }, ['j.ngc', 's.json']],
  ['JSON', { 'k.ngc': 'G21\n', 's.json': '{"name": ' }, ['k.ngc', 's.json']],
];

async function wasmIn(at) {
  const wasi = new WASI({ version: 'preview1', preopens: { '.': at } });
  const module = await WebAssembly.compile(readFileSync(file));
  const { exports: calls } = await WebAssembly.instantiate(module, wasi.getImportObject());
  wasi.initialize({ exports: calls });
  const put = (text) => {
    const bytes = Buffer.from(text);
    const to = calls.kerf_input(bytes.length);
    new Uint8Array(calls.memory.buffer, to, bytes.length).set(bytes);
  };
  const text = (bytes) =>
    Buffer.from(calls.memory.buffer, calls.kerf_output(), bytes).toString('utf8');
  return { calls, put, text };
}

/** Carves in parts, and writes models. With `seeks` it first goes back and forth. */
async function carveInPage(at, names, seeks) {
  const { calls, put, text } = await wasmIn(at);
  const began = process.cpuUsage();
  const must = (bytes) => {
    if (bytes > 0) throw new Error(text(bytes));
  };
  put(names.join('\n'));
  must(calls.kerf_read());
  must(calls.kerf_make());
  const { motions, derived } = JSON.parse(text(calls.kerf_about()));
  const carved = () => JSON.parse(text(calls.kerf_progress())).carved;
  while (carved() < motions) must(calls.kerf_carve(97));
  const { user, system } = process.cpuUsage(began);
  const seconds = (user + system) / 1e6;
  const hash = () => BigInt.asUintN(64, calls.kerf_hash()).toString(16).padStart(16, '0');
  const atEnd = hash();
  if (seeks) checkSeeking(calls, motions, hash, must);
  for (const format of ['3mf', 'stl']) {
    put(format);
    must(calls.kerf_write());
    renameSync(join(at, 'model'), join(at, `page.${format}`));
  }
  return { hash: atEnd, motions, derived, seconds };
}

/** Returns to the middle twice: the states are equal, and the displayed tiles follow them. */
function checkSeeking(calls, motions, hash, must) {
  const shown = new Map();
  const mesh = (x, y) => {
    const vertices = calls.kerf_mesh(x, y);
    const corners = new Uint32Array(calls.memory.buffer, calls.kerf_output(), 1)[0];
    const bytes = 4 + 25 * vertices + 4 * corners;
    return Buffer.from(calls.memory.buffer, calls.kerf_output(), bytes).toString('latin1');
  };
  const show = () => {
    const count = calls.kerf_changed();
    const places = new Int32Array(calls.memory.buffer.slice(calls.kerf_output()), 0, 2 * count);
    for (let n = 0; n < count; ++n) {
      const [x, y] = places.subarray(2 * n);
      shown.set(`${x} ${y}`, mesh(x, y));
    }
    for (const [at, bytes] of shown)
      assert(mesh(...at.split(' ').map(Number)) === bytes, `tile ${at} has changed unseen`);
  };
  const carve = (to) => {
    calls.kerf_seek(to);
    must(calls.kerf_carve(to - JSON.parse(progress(calls)).carved));
    show();
  };
  const [atEnd, middle] = [hash(), motions >> 1];
  show();
  carve(middle);
  const inMiddle = hash();
  assert.notEqual(inMiddle, atEnd, 'going back changes nothing');
  carve(motions);
  assert.equal(hash(), atEnd, 'the state after going back and on differs');
  carve(2);
  carve(middle);
  assert.equal(hash(), inMiddle);
  carve(motions);
}

function progress(calls) {
  const bytes = calls.kerf_progress();
  return Buffer.from(calls.memory.buffer, calls.kerf_output(), bytes).toString('utf8');
}

function optionsOf([program, sceneFile, stock]) {
  const options = ['--program', program, '--threads', '1'];
  if (sceneFile) options.push('--scene', sceneFile);
  if (stock) options.push('--stock', stock);
  return options;
}

function carveHere(at, names, ...more) {
  return spawnSync(carve, [...optionsOf(names), ...more], { cwd: at, encoding: 'utf8' });
}

const OUTPUTS = ['--stl', 'here.stl', '--3mf', 'here.3mf', '--report', 'here.json'];

function write(name, files) {
  const at = join(folder, name.replace(/\W+/g, '_'));
  rmSync(at, { recursive: true, force: true });
  mkdirSync(at, { recursive: true });
  for (const [one, text] of Object.entries(files)) writeFileSync(join(at, one), text);
  return at;
}

/** The parts of a ZIP archive, by their names. */
function partsOf(zip) {
  const parts = {};
  const end = zip.lastIndexOf('PK\x05\x06', undefined, 'latin1');
  let at = zip.readUInt32LE(end + 16);
  for (let n = zip.readUInt16LE(end + 10); n > 0; --n) {
    const [packed, nameBytes, extra] = [20, 28, 30].map((to) =>
      to === 20 ? zip.readUInt32LE(at + to) : zip.readUInt16LE(at + to),
    );
    const local = zip.readUInt32LE(at + 42);
    const from = local + 30 + zip.readUInt16LE(local + 26) + zip.readUInt16LE(local + 28);
    const bytes = zip.subarray(from, from + packed);
    const plain = zip.readUInt16LE(at + 10) === 0 ? bytes : inflateRawSync(bytes);
    const name = zip.toString('utf8', at + 46, at + 46 + nameBytes);
    const crc = zip.readUInt32LE(at + 16);
    assert.equal(zip.readUInt32LE(local + 14), crc, `${name}: the two headers differ`);
    parts[name] = { crc, sha: createHash('sha256').update(plain).digest('hex') };
    at += 46 + nameBytes + extra + zip.readUInt16LE(at + 32);
  }
  assert.equal(Object.keys(parts).length, 3);
  return parts;
}

async function compare(name, files, names, seeks = false) {
  const at = write(name, files);
  const here = carveHere(at, names, ...OUTPUTS);
  assert.equal(here.status, 0, here.stderr);
  const report = JSON.parse(readFileSync(join(at, 'here.json'), 'utf8'));
  const page = await carveInPage(at, names, seeks);
  assert.equal(page.hash, report.state_hash, `${name}: the state differs from kerf-carve's`);
  assert(report.removed_volume_mm3 > 1, `${name}: nothing was removed`);
  const [one, other] = ['page.stl', 'here.stl'].map((file) => readFileSync(join(at, file)));
  assert(one.equals(other), `${name}: the STL file differs from kerf-carve's`);
  const [parts, others] = ['page.3mf', 'here.3mf'].map((file) =>
    partsOf(readFileSync(join(at, file))),
  );
  assert.deepEqual(parts, others, `${name}: the parts of the 3MF file differ from kerf-carve's`);
  assert.deepEqual(page.derived, derivedHere(at, names), `${name}: another scene is derived`);
  console.log(`${name}: ${page.motions} motions, ${page.hash}, ${one.length} bytes`);
  if (given.length > 0) printTimes(at, names, page.seconds);
}

/** The scene that kerf-carve derives, or null if one is given. */
function derivedHere(at, names) {
  if (names[1]) return null;
  const { status, stdout, stderr } = carveHere(at, names, '--derive');
  assert.equal(status, 0, stderr);
  return JSON.parse(stdout);
}

/** CPU time of reading and carving, on one thread. */
function printTimes(at, names, pageSeconds) {
  const times = ['-c', 'TIMEFORMAT="%U %S"; time "$0" "$@" 2>/dev/null', carve];
  const { stderr } = spawnSync('bash', [...times, ...optionsOf(names), '--wall-samples', '0'], {
    cwd: at,
    encoding: 'utf8',
  });
  const here = stderr
    .trim()
    .split(' ')
    .reduce((sum, part) => sum + Number(part), 0);
  const ratio = (pageSeconds / here).toFixed(1);
  console.log(`CPU: ${pageSeconds.toFixed(2)} s, kerf-carve ${here.toFixed(2)} s: ${ratio} times`);
}

async function compareFault(name, files, names) {
  const at = write(`fault of ${name}`, files);
  const here = carveHere(at, names, '--report', 'here.json');
  assert.equal(here.status, 2);
  await assert.rejects(carveInPage(at, names), { message: here.stderr.trim().split('\n').at(-1) });
  console.log(`${name}: ${here.stderr.trim()}`);
}

if (!existsSync(file)) {
  console.log(`skipped: there is no ${file} (web/wasm/README.md)`);
  process.exit(77);
}
const size = gzipSync(readFileSync(file), { level: 9 }).length;
console.log(`kerf_files.wasm: ${size} bytes with gzip`);
if (given.length > 0) {
  const names = given.map((path) => basename(path));
  await compare(
    'given',
    Object.fromEntries(given.map((p) => [basename(p), readFileSync(p)])),
    names,
  );
} else {
  for (const [n, job] of JOBS.entries()) await compare(...job, n === 0);
  for (const fault of FAULTS) await compareFault(...fault);
}
