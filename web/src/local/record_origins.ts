// SPDX-License-Identifier: Apache-2.0
// The origins of the records that this page adds to a .kerf file (manual/kerf-file.md): a merge of
// two copies knows by them which strokes both have.

import type { Database } from 'sql.js';
import { crc32 } from './crc32';
import { integer } from './kerf_file';

const TABLE = `CREATE TABLE IF NOT EXISTS origins(first INTEGER PRIMARY KEY, writer TEXT NOT NULL,
  number INTEGER NOT NULL, clock INTEGER NOT NULL, crc INTEGER NOT NULL)`;
const WRITER_BYTES = 16;

/** A name that no other writer has. A page takes one for each block that it opens. */
export function newWriter(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(WRITER_BYTES));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** As RecordOrigins::next_clock of server/store/record_origins.h: after all Lamport times. */
function nextClock(database: Database, last: number): number {
  const ends = `SELECT clock + coalesce(lead(first) OVER (ORDER BY first), ${last + 1}) - first AS it
                FROM origins WHERE first <= ${last}`;
  // The Lamport time of a record that has no row is its number.
  const first = integer(database, `SELECT coalesce(min(first), ${last + 1}) FROM origins`);
  return Math.max(integer(database, `SELECT max(it) FROM (${ends})`), Math.min(first, last + 1));
}

function checksum(writer: string, values: readonly number[]): number {
  const text = new TextEncoder().encode(`${writer}\0`);
  const bytes = new Uint8Array(text.length + 8 * values.length);
  bytes.set(text);
  const view = new DataView(bytes.buffer, text.length);
  values.forEach((value, n) => {
    view.setBigInt64(8 * n, BigInt(value), true);
  });
  return crc32(bytes);
}

/** Notes that the records after those that a file has now are of `writer`. */
export function beginWriter(database: Database, writer: string): void {
  database.run(TABLE);
  const last = integer(database, 'SELECT max(first + count - 1) FROM batches');
  const row = [last + 1, last + 1, nextClock(database, last)];
  const insert = 'INSERT OR REPLACE INTO origins(first, number, clock, writer, crc)';
  database.run(`${insert} VALUES(?,?,?,?,?)`, [...row, writer, checksum(writer, row)]);
}
