// SPDX-License-Identifier: Apache-2.0
// The files that a failed test leaves for a look: its options, the output of the programs that it has
// started, and its pages as they were. All of it is written while the test runs, because a test that
// takes too long is killed.

import { createWriteStream, existsSync, mkdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';

const folder =
  process.env.KERF_FAILED ?? join(tmpdir(), 'kerf-failed', basename(process.argv[1], '.mjs'));
let options = null;
let begun = false;
let count = 0;

/** Has the options kept with the rest: they have the seed, if there is one. */
export function noteOptions(values) {
  options = values;
}

/** Empties the folder of what an earlier run has left there. */
export function beginKeeping() {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  begun = true;
  if (options) keep('options.json', JSON.stringify(options, null, 2));
}

/** Writes a file of this name. */
export function keep(name, content) {
  if (begun) writeFileSync(join(folder, name), content);
}

/** Where the output of a program goes: a stream. */
export function keptOutput(program) {
  if (!begun) return null;
  count += 1;
  return createWriteStream(join(folder, `${String(count).padStart(2, '0')}-${program}.log`));
}

/**
 * Keeps a picture of each page and its own account of its state. A page that answers nothing is left
 * out: the reason of the failure is another.
 */
export async function keepPages(pages) {
  for (const [n, page] of pages.entries()) {
    try {
      keep(`page-${n + 1}.png`, await page.screenshot({ timeout: 20_000 }));
      const state = await page.evaluate(() => window.kerf?.state());
      const facts = { url: page.url(), state };
      keep(`page-${n + 1}.json`, JSON.stringify(facts, null, 2));
    } catch (problem) {
      keep(`page-${n + 1}.txt`, `${page.url()}: ${problem.message}`);
    }
  }
}

/** The test has passed: nothing is left of it. */
export function forget() {
  begun = false;
  rmSync(folder, { recursive: true, force: true });
}

/** Writes why the test has failed; returns where everything is. */
export function keepProblem(problem) {
  if (!existsSync(folder)) return null;
  keep('problem.txt', `${problem?.stack ?? problem}\n`);
  return folder;
}
