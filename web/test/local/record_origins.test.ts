// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { crc32 as crcOfZlib } from 'node:zlib';
import type { SqlValue } from 'sql.js';
import { afterAll, beforeAll, describe, expect, it, vi } from 'vitest';
import { crc32 } from '../../src/local/crc32';
import { each, openDatabase } from '../../src/local/kerf_file';
import { writeKerfFile } from '../../src/local/kerf_file_writer';
import type { JournalParts } from '../../src/local/program_block';
import { newWriter } from '../../src/local/record_origins';

const SQLITE = createRequire(import.meta.url).resolve('sql.js/dist/sql-wasm.wasm');

/** Rows of batches as the kernel's module gives them; the records themselves do not matter here. */
function rowsOf(...batches: { first: number; count: number }[]): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(40 * batches.length);
  const view = new DataView(bytes.buffer);
  batches.forEach(({ first, count }, n) => {
    view.setBigInt64(40 * n, BigInt(first), true);
    view.setBigInt64(40 * n + 8, BigInt(count), true);
  });
  return bytes;
}

function parts(...batches: { first: number; count: number }[]): JournalParts {
  const bytes = new TextEncoder().encode('wave');
  const { first, count } = batches.at(-1)!;
  return {
    ...{ id: bytes, scene: bytes, sceneCrc: 0, files: [], tools: [] },
    ...{ rows: rowsOf(...batches), record: first + count - 1, hash: '00ff', kernelVersion: 10 },
  };
}

async function originsOf(file: Uint8Array): Promise<SqlValue[][]> {
  const database = await openDatabase(file);
  const rows: SqlValue[][] = [];
  const query = 'SELECT first, writer, number, clock, crc FROM origins ORDER BY first';
  each(database, query, (row) => rows.push(row));
  database.close();
  return rows;
}

async function changed(file: Uint8Array, sql: string): Promise<Uint8Array> {
  const database = await openDatabase(file);
  database.run(sql);
  const bytes = database.export();
  database.close();
  return bytes;
}

function crcOf(writer: string, ...numbers: number[]): number {
  const fields = Buffer.alloc(8 * numbers.length);
  numbers.forEach((value, n) => fields.writeBigInt64LE(BigInt(value), 8 * n));
  return crcOfZlib(fields, crcOfZlib(`${writer}\0`));
}

describe('the origins of records that a page adds', () => {
  beforeAll(() => {
    vi.stubGlobal('fetch', () => Promise.resolve(new Response(readFileSync(SQLITE))));
  });
  afterAll(() => {
    vi.unstubAllGlobals();
  });

  it('begin with the first record of a new file', async () => {
    const file = await writeKerfFile(parts({ first: 1, count: 5 }), [], null, 'ab');
    expect(await originsOf(file)).toEqual([[1, 'ab', 1, 1, crcOf('ab', 1, 1, 1)]]);
  });

  it('begin after the records of the file that was opened, each time it is written', async () => {
    const before = await writeKerfFile(parts({ first: 1, count: 5 }), [], null, 'ab');
    for (const more of [2, 7]) {
      const both = parts({ first: 1, count: 5 }, { first: 6, count: more });
      const file = await writeKerfFile(both, [], before, 'cd');
      expect((await originsOf(file))[1]).toEqual([6, 'cd', 6, 6, crcOf('cd', 6, 6, 6)]);
    }
  });

  it('have a Lamport time after all of the file', async () => {
    const before = await writeKerfFile(parts({ first: 1, count: 9 }), [], null, 'ab');
    const merged = await changed(
      before,
      "INSERT INTO origins VALUES(4,'cd',30,70,0),(6,'ab',4,4,0)",
    );
    const file = await writeKerfFile(parts({ first: 1, count: 9 }), [], merged, 'ef');
    expect((await originsOf(file)).at(-1)!.slice(0, 4)).toEqual([10, 'ef', 10, 72]);
    const old = await changed(before, 'DROP TABLE origins');
    const newer = await writeKerfFile(parts({ first: 1, count: 9 }), [], old, 'ef');
    expect((await originsOf(newer)).map((row) => row.slice(0, 4))).toEqual([[10, 'ef', 10, 10]]);
  });

  it('have a writer of its own for each block', () => {
    const writers = Array.from({ length: 50 }, newWriter);
    expect(new Set(writers).size).toBe(50);
    expect(writers.every((writer) => /^[0-9a-f]{32}$/.test(writer))).toBe(true);
  });

  it('are protected by the checksum of zlib', () => {
    const bytes = Uint8Array.from({ length: 1000 }, (_, n) => (n * n) % 251);
    for (const length of [0, 1, 9, 1000])
      expect(crc32(bytes.subarray(0, length))).toBe(crcOfZlib(bytes.subarray(0, length)));
  });
});
