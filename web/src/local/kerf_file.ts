// SPDX-License-Identifier: Apache-2.0
// Reads a .kerf file, the journal of a session (manual/kerf-file.md), which is an SQLite database.
// Its records are passed on as they are; the kernel's module verifies and decodes them.

import initSqlJs from 'sql.js';
import type { Database, SqlValue } from 'sql.js';
import sqliteUrl from 'sql.js/dist/sql-wasm-browser.wasm?url';
import { t } from '../strings';
import type { ParticipantInfo } from '../wire/types';
import type { GivenJournal } from './program_block';

export const APPLICATION_ID = 0x4b455246; // "KERF"
export const VERSION = 2;
/** Of an SQLite file: which journal of SQLite's own it has; 2: a write-ahead log. */
const MODE_BYTES = [18, 19] as const;
const ROLLBACK = 1;

export interface KerfFile {
  journal: GivenJournal;
  participants: ParticipantInfo[];
  /** The newest state hash that is stored, and after which record; null: none. */
  stored: { record: number; hash: string } | null;
  /** Of the kernel that computed the stored hashes. */
  kernelVersion: number;
}

/** Little-endian numbers and bytes, one after the other. */
class Bytes {
  private readonly parts_: Uint8Array[] = [];

  u32(value: number): this {
    const bytes = new Uint8Array(4);
    new DataView(bytes.buffer).setUint32(0, value, true);
    this.parts_.push(bytes);
    return this;
  }
  i64(value: number): this {
    const bytes = new Uint8Array(8);
    new DataView(bytes.buffer).setBigInt64(0, BigInt(value), true);
    this.parts_.push(bytes);
    return this;
  }
  raw(bytes: Uint8Array): this {
    this.parts_.push(bytes);
    return this;
  }
  text(bytes: Uint8Array): this {
    return this.u32(bytes.length).raw(bytes);
  }
  take(): Uint8Array<ArrayBuffer> {
    const size = this.parts_.reduce((sum, { length }) => sum + length, 0);
    const all = new Uint8Array(size);
    let at = 0;
    for (const part of this.parts_) {
      all.set(part, at);
      at += part.length;
    }
    return all;
  }
}

function bytesOf(value: SqlValue | undefined): Uint8Array {
  return value instanceof Uint8Array ? value : new TextEncoder().encode(String(value ?? ''));
}

export function each(database: Database, query: string, use: (row: SqlValue[]) => void): void {
  const rows = database.prepare(query);
  while (rows.step()) use(rows.get());
  rows.free();
}

/** The first column of the last row of a query; 0: none. */
export function integer(database: Database, query: string): number {
  let found = 0;
  each(database, query, ([value]) => (found = Number(value ?? 0)));
  return found;
}

function hasTable(database: Database, name: string): boolean {
  const where = `type='table' AND name='${name}'`;
  return integer(database, `SELECT count(*) FROM sqlite_master WHERE ${where}`) > 0;
}

/** The scene with the tools that were made since, and the name that the session has now. */
function sceneOf(database: Database, scene: Uint8Array): Uint8Array {
  const made: unknown[] = [];
  if (hasTable(database, 'tools'))
    each(database, 'SELECT json FROM tools ORDER BY tool', ([json]) =>
      made.push(JSON.parse(String(json))),
    );
  const named: { name?: string } = {};
  if (hasTable(database, 'names'))
    each(database, 'SELECT name FROM names', ([name]) => (named.name = String(name)));
  if (made.length === 0 && named.name === undefined) return scene;
  const all = JSON.parse(new TextDecoder().decode(scene)) as { tools: unknown[] };
  return bytesOf(JSON.stringify({ ...all, ...named, tools: [...all.tools, ...made] }));
}

/** As encode_origin of server/store/journal_origin.h. */
function originOf(database: Database): Uint8Array<ArrayBuffer> {
  const files: Uint8Array[] = [];
  if (hasTable(database, 'files'))
    each(database, 'SELECT name, bytes FROM files', ([name, bytes]) =>
      files.push(bytesOf(name), bytesOf(bytes)),
    );
  const texts: Uint8Array[] = [];
  each(database, 'SELECT id, scene FROM session', ([id, scene]) =>
    texts.push(bytesOf(id), sceneOf(database, bytesOf(scene))),
  );
  texts.push(...files);
  const out = new Bytes().u32(texts.length);
  for (const text of texts) out.text(text);
  return out.take();
}

/** As append_span_row of server/store/record_span.h. */
function spanOf(database: Database): Uint8Array<ArrayBuffer> {
  const out = new Bytes();
  const query = 'SELECT first, count, wall_ms, span_ms, crc, bytes FROM batches ORDER BY first';
  each(database, query, ([first, count, wall, span, crc, bytes]) => {
    const records = bytesOf(bytes);
    out.i64(Number(first)).i64(Number(count)).i64(Number(wall)).i64(Number(span));
    out
      .u32(Number(crc) >>> 0)
      .u32(records.length)
      .raw(records);
  });
  return out.take();
}

/** A row of the table of batches. */
export interface BatchRow {
  first: number;
  count: number;
  wallMs: number;
  spanMs: number;
  crc: number;
  bytes: Uint8Array<ArrayBuffer>;
}

const ROW_HEAD_BYTES = 40; // kSpanRowHeadBytes of server/store/record_span.h

/** The rows of a span. */
export function* rowsOf(span: Uint8Array<ArrayBuffer>): Generator<BatchRow> {
  const numbers = new DataView(span.buffer, span.byteOffset, span.byteLength);
  for (let at = 0; at < span.length;) {
    const i64 = (offset: number): number => Number(numbers.getBigInt64(at + offset, true));
    const end = at + ROW_HEAD_BYTES + numbers.getUint32(at + 36, true);
    yield {
      first: i64(0),
      count: i64(8),
      wallMs: i64(16),
      spanMs: i64(24),
      crc: numbers.getInt32(at + 32, true),
      bytes: span.slice(at + ROW_HEAD_BYTES, end),
    };
    at = end;
  }
}

function storedHash(database: Database): KerfFile['stored'] {
  let stored: KerfFile['stored'] = null;
  const query =
    "SELECT sequence, printf('%016x', hash) FROM state_hashes ORDER BY sequence DESC LIMIT 1";
  each(database, query, ([record, hash]) => {
    stored = { record: Number(record), hash: String(hash) };
  });
  return stored;
}

function participantsOf(database: Database): ParticipantInfo[] {
  const list: ParticipantInfo[] = [];
  each(database, 'SELECT participant, name, color, kind FROM participants', (row) => {
    const [participant, name, color, kind] = row;
    const isProgram = kind === 'program';
    list.push({
      participant: Number(participant),
      name: String(name),
      color: String(color),
      tool: 0,
      kind: isProgram ? 'program' : 'agent',
    });
  });
  return list;
}

/** An error of the file, which the message names. Other errors here come from SQLite. */
class FileFault extends Error {}

function check(database: Database): void {
  if (integer(database, 'PRAGMA application_id') !== APPLICATION_ID)
    throw new FileFault(t('this is not a KERF file'));
  const version = integer(database, 'PRAGMA user_version');
  const hasSingles =
    hasTable(database, 'commands') && integer(database, 'SELECT count(*) FROM commands') > 0;
  if (version !== VERSION || hasSingles)
    throw new FileFault(t('this KERF file is too old for this page: open it with kerf-server'));
}

/** Opens a copy of a file in memory; null: a new one. */
export async function openDatabase(given: Uint8Array | null): Promise<Database> {
  // Its own loading needs a host that sends the module as application/wasm.
  const wasmBinary = await (await fetch(sqliteUrl)).arrayBuffer();
  const sql = await initSqlJs({ wasmBinary });
  if (!given) return new sql.Database();
  const bytes = given.slice();
  // A database of one file has no separate log, which SQLite would look for.
  for (const at of MODE_BYTES) if (bytes[at] === 2) bytes[at] = ROLLBACK;
  return new sql.Database(bytes);
}

/** The error of a file that SQLite does not read. */
function faultOf(problem: unknown): unknown {
  if (problem instanceof FileFault || !(problem instanceof Error)) return problem;
  return problem.message === 'file is not a database'
    ? new FileFault(t('this is not a KERF file'))
    : new FileFault(
        t(
          'this KERF file is damaged ({0}): run “kerf-server check” to see what can be saved',
          problem.message,
        ),
      );
}

/** Rejects with a clause that names the file's error. */
export async function readKerfFile(given: Uint8Array): Promise<KerfFile> {
  const database = await openDatabase(given);
  try {
    check(database);
    return {
      journal: { origin: originOf(database), spans: [spanOf(database)] },
      participants: participantsOf(database),
      stored: storedHash(database),
      kernelVersion: hasTable(database, 'kernel_versions')
        ? integer(database, 'SELECT version FROM kernel_versions ORDER BY sequence DESC LIMIT 1')
        : 1,
    };
  } catch (problem) {
    throw faultOf(problem);
  } finally {
    database.close();
  }
}
