// SPDX-License-Identifier: Apache-2.0
// Starts the programs under test with captured output, and stops them at the end, also after a
// failure.

import { spawn } from 'node:child_process';

const running = new Set();

/**
 * Starts a program. `lines` collects its standard output, `errors` its standard error; `ended`
 * resolves to the exit code.
 */
export function start(program, parameters) {
  const child = spawn(program, parameters, { stdio: ['ignore', 'pipe', 'pipe'] });
  const process_ = { child, name: program.split('/').at(-1), lines: [], errors: '' };
  let rest = '';
  child.stdout.on('data', (data) => {
    const parts = (rest + data).split('\n');
    rest = parts.pop();
    process_.lines.push(...parts);
  });
  child.stderr.on('data', (data) => {
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

export async function stopAll() {
  await Promise.all([...running].map((process_) => stop(process_)));
}

/**
 * Polls until `probe` returns a truthy value, and returns it. Throws after `seconds` with the name
 * of what was awaited.
 */
export async function until(what, seconds, probe) {
  const end = Date.now() + seconds * 1000;
  let last;
  for (;;) {
    try {
      const value = await probe();
      if (value) return value;
    } catch (problem) {
      last = problem;
    }
    if (Date.now() > end)
      throw new Error(`timeout after ${seconds} s: no ${what}${last ? ` (${last.message})` : ''}`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}
