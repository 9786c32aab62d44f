// SPDX-License-Identifier: Apache-2.0
// The traces of a failed end-to-end test stay until it passes: its options, and all that its programs
// wrote. Needs no browser.
//
// node kept_test.mjs

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const folder = await mkdtemp(join(tmpdir(), 'kerf-kept-'));
const kept = join(folder, 'failed');
const support = new URL('./support/', import.meta.url);
const TEST = `
import { keepPages } from '${support}kept.mjs';
import { atEnd, run } from '${support}processes.mjs';
import { optionsOf, runTest } from '${support}session.mjs';
const { fails } = optionsOf(['fails'], { seed: '7' });
const page = { screenshot: () => Buffer.from('a picture'), evaluate: () => ({ hash: 'a' }), url: () => 'x' };
await runTest(async () => {
  atEnd(() => console.log('closed'));
  await run('/bin/sh', ['-c', 'echo said; echo warned >&2']);
  await keepPages([page]);
  if (fails === 'yes') throw new Error('as it should');
});
`;

function runProgram(fails) {
  return spawnSync(process.execPath, [join(folder, 'test.mjs'), '--fails', fails], {
    encoding: 'utf8',
    env: { ...process.env, KERF_FAILED: kept },
  });
}

const read = (name) => readFileSync(join(kept, name), 'utf8');

try {
  await writeFile(join(folder, 'test.mjs'), TEST);
  const bad = runProgram('yes');
  assert.equal(bad.status, 1, bad.stderr);
  assert.match(bad.stderr, /as it should/);
  assert(bad.stderr.endsWith(`logs, options and screenshots: ${kept}\n`), bad.stderr);
  assert.equal(bad.stdout, 'closed\n');
  assert.deepEqual(readdirSync(kept).sort(), [
    ...['01-sh.log', 'options.json', 'page-1.json', 'page-1.png', 'problem.txt'],
  ]);
  assert.deepEqual(read('01-sh.log').split('\n').sort(), ['', 'said', 'warned']);
  assert.deepEqual(JSON.parse(read('options.json')), { fails: 'yes', seed: '7' });
  assert.deepEqual(JSON.parse(read('page-1.json')), { url: 'x', state: { hash: 'a' } });
  assert.match(read('problem.txt'), /^Error: as it should/);
  const good = runProgram('no');
  assert.equal(good.status, 0, good.stderr);
  assert.equal(good.stdout, 'ok\nclosed\n');
  assert(!existsSync(kept), 'a test that passes leaves something');
  console.log('ok');
} finally {
  await rm(folder, { recursive: true });
}
