// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { afterAll, beforeAll, describe, expect, it, vi } from 'vitest';
import { APPLICATION_ID, openDatabase, readKerfFile, VERSION } from '../../src/local/kerf_file';

const SQLITE = createRequire(import.meta.url).resolve('sql.js/dist/sql-wasm.wasm');

/** A database with the marks of a journal, and rows that take several pages. */
async function marked(): Promise<Uint8Array> {
  const database = await openDatabase(null);
  database.run(`PRAGMA application_id=${APPLICATION_ID}; PRAGMA user_version=${VERSION}`);
  database.run('CREATE TABLE origin(name TEXT)');
  for (let n = 0; n < 100; ++n) database.run('INSERT INTO origin VALUES (?)', ['x'.repeat(1000)]);
  const bytes = database.export();
  database.close();
  return bytes;
}

describe('a file that is no good journal', () => {
  beforeAll(() => {
    vi.stubGlobal('fetch', () => Promise.resolve(new Response(readFileSync(SQLITE))));
  });
  afterAll(() => {
    vi.unstubAllGlobals();
  });

  it('is not taken for a journal', async () => {
    const other = new TextEncoder().encode('solid cube\n'.repeat(500));
    await expect(readKerfFile(other)).rejects.toThrow(/^this is not a KERF file$/);
    const empty = await openDatabase(null);
    empty.run('CREATE TABLE notes(text TEXT)');
    const notes = empty.export();
    empty.close();
    await expect(readKerfFile(notes)).rejects.toThrow(/^this is not a KERF file$/);
  });

  it("is called damaged, with SQLite's message and a remedy", async () => {
    const bytes = await marked();
    const broken = bytes.slice(0, bytes.length / 2).fill(0xa5, 4096);
    await expect(readKerfFile(broken)).rejects.toThrow(
      /^this KERF file is damaged \(.+\): run “kerf-server check” to see what can be saved$/,
    );
  });
});
