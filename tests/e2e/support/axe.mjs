// SPDX-License-Identifier: Apache-2.0
// Checks a page by the rules of WCAG 2.2 A and AA that can be checked by a program (axe-core).

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { readFile } from 'node:fs/promises';

const SOURCE = createRequire(import.meta.url).resolve('axe-core/axe.min.js');
const TAGS = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];

/** Asserts that the page, as it is now, violates no rule. */
export async function checkAccessible(page, what) {
  await page.evaluate(await readFile(SOURCE, 'utf8'));
  const found = await page.evaluate(async (tags) => {
    const { violations } = await window.axe.run({ runOnly: tags });
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(' ')}`);
  }, TAGS);
  assert.deepEqual(found, [], `${what} violates rules`);
}
