// SPDX-License-Identifier: Apache-2.0
// Starts the programs under test with captured output, and stops them at the end, also after a
// failure.

import { spawn } from 'node:child_process';
import { keptOutput } from './kept.mjs';

const running = new Set();
const ends = [];

/**
 * Starts a program. `lines` collects its standard output, `errors` its standard error; `ended`
 * resolves to the exit code.
 */
export function start(program, parameters) {
  const child = spawn(program, parameters, { stdio: ['ignore', 'pipe', 'pipe'] });
  const process_ = { child, name: program.split('/').at(-1), lines: [], errors: '' };
  const kept = keptOutput(process_.name);
  let rest = '';
  child.stdout.on('data', (data) => {
    kept?.write(data);
    const parts = (rest + data).split('\n');
    rest = parts.pop();
    process_.lines.push(...parts);
  });
  child.stderr.on('data', (data) => {
    kept?.write(data);
    process_.errors += data;
  });
  process_.ended = new Promise((resolve) => {
    child.on('error', (problem) => {
      process_.errors += problem.message;
      resolve(-1);
    });
    child.on('close', (code, signal) => {
      if (rest) process_.lines.push(rest);
      running.delete(process_);
      kept?.end();
      process_.code = code ?? signal;
      resolve(process_.code);
    });
  });
  running.add(process_);
  return process_;
}

/** Runs a program to its end; throws with its output if it fails. */
export async function run(program, parameters) {
  const process_ = start(program, parameters);
  const code = await process_.ended;
  if (code !== 0)
    throw new Error(
      `${process_.name} ended with ${code}: ${process_.errors}${process_.lines.join('\n')}`,
    );
  return process_.lines.join('\n');
}

/** On a busy machine a server that hands its sessions over takes its time. */
const STOP_MS = 30_000;

/**
 * Stops a program by a signal, and kills it if it is still running after STOP_MS. Returns its exit
 * code.
 */
export async function stop(process_, signal = 'SIGTERM') {
  if (!running.has(process_)) return process_.code;
  process_.child.kill(signal);
  const kill = setTimeout(() => process_.child.kill('SIGKILL'), STOP_MS);
  const code = await process_.ended;
  clearTimeout(kill);
  return code;
}

/** Calls `close` at the end of the test, also after a failure. */
export function atEnd(close) {
  ends.push(close);
}

export async function stopAll() {
  for (const close of ends.splice(0).reverse()) await close();
  await Promise.all([...running].map((process_) => stop(process_)));
}

/**
 * Polls until `probe` returns a truthy value, and returns it; null after `seconds`. `failed` gets
 * what `probe` throws.
 */
export async function poll(seconds, probe, failed = () => {}) {
  const end = Date.now() + seconds * 1000;
  for (;;) {
    try {
      const value = await probe();
      if (value) return value;
    } catch (problem) {
      failed(problem);
    }
    if (Date.now() > end) return null;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

/** As poll(); throws after `seconds` with the name of what was awaited. */
export async function until(what, seconds, probe) {
  let last;
  const value = await poll(seconds, probe, (problem) => (last = problem));
  if (value !== null) return value;
  throw new Error(`timeout after ${seconds} s: no ${what}${last ? ` (${last.message})` : ''}`);
}
