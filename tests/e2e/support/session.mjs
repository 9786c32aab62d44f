// SPDX-License-Identifier: Apache-2.0
// The common begin and end of the tests: options, a folder that is deleted, a server with a session, and
// programs that it carves.

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { mkdir, mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { parseArgs } from 'node:util';
import { beginKeeping, forget, keepProblem, noteOptions } from './kept.mjs';
import { start, stopAll, until } from './processes.mjs';

const SETTLE_S = 60; // on a busy machine

/** The options of the command line, all of which are needed; `others` have values otherwise. */
export function optionsOf(names, others = {}) {
  const options = Object.fromEntries(names.map((name) => [name, { type: 'string' }]));
  for (const [name, value] of Object.entries(others))
    options[name] = { type: 'string', default: value };
  const { values } = parseArgs({ options });
  for (const name of names) assert(values[name], `--${name} is missing`);
  noteOptions(values);
  return values;
}

/**
 * Runs a test in a folder of its own, then stops what it started. Sets the exit code, and says where
 * logs and screenshots of a test are that has failed (kept.mjs).
 */
export async function runTest(test, out) {
  if (out) await mkdir(out, { recursive: true });
  const folder = await mkdtemp(join(tmpdir(), 'kerf-e2e-'));
  beginKeeping();
  let kept = null;
  try {
    await test(folder);
    console.log('ok');
  } catch (problem) {
    console.error(problem);
    process.exitCode = 1;
    kept = keepProblem(problem);
  } finally {
    await stopAll();
    await rm(folder, { recursive: true, force: true });
  }
  if (kept === null) forget();
  else console.error(`logs, options and screenshots: ${kept}`);
}

/** Starts a server without sessions on a free port, with data in `folder`; `others` are options. */
export async function startEmptyServer({ server: program, web, others = [] }, folder) {
  const data = join(folder, 'data');
  const server = start(program, [
    '--listen',
    '127.0.0.1:0',
    '--data',
    data,
    '--web',
    web,
    ...others,
  ]);
  const base = await until('server address', SETTLE_S, () => {
    assert.equal(server.code, undefined, `the server exited: ${server.errors}`);
    return server.lines.find((line) => line.startsWith('http'));
  });
  return { server, base };
}

/** Starts such a server, and a session of a scene. */
export async function startServer(options, folder, id, scene) {
  const { server, base } = await startEmptyServer(options, folder);
  const body = JSON.stringify(scene);
  const created = await fetch(`${base}/v1/sessions?id=${id}`, {
    method: 'POST',
    body,
  });
  assert.equal(created.status, 201, await created.text());
  return { server, base, session: `${base}/v1/sessions/${id}` };
}

export async function getJson(url) {
  const response = await fetch(url);
  assert.equal(response.status, 200, `${url} answered ${response.status}`);
  return response.json();
}

/** Carves an NC program to its end; `query` as in server/http/README.md. Returns its number. */
export async function carveProgram(session, text, query) {
  const posted = await fetch(`${session}/programs?${query}`, {
    method: 'POST',
    body: text,
  });
  assert.equal(posted.status, 202, await posted.clone().text());
  const { id } = await posted.json();
  await until('end of the program', SETTLE_S, async () => {
    const { state, error } = await getJson(`${session}/programs/${id}`);
    assert.notEqual(state, 'failed', error);
    return state === 'finished';
  });
  return id;
}

/** As runTest, for a page that carves by itself: skipped where it was built without that module. */
export async function runFilesTest(test, { web, out }) {
  if (existsSync(join(web, 'kerf_files.wasm'))) {
    await runTest(test, out);
    return;
  }
  console.log('skipped: the page was built without kerf_files.wasm (web/wasm/README.md)');
  process.exit(77);
}
