// SPDX-License-Identifier: Apache-2.0
// Writes a .kerf file, the journal of a session (manual/kerf-file.md), of a block that was carved
// in the page. A kerf-server opens it as its own.

import type { Database } from 'sql.js';
import type { ParticipantInfo } from '../wire/types';
import { APPLICATION_ID, openDatabase, rowsOf, VERSION } from './kerf_file';
import type { JournalParts } from './program_block';
import { beginWriter } from './record_origins';

/** As server/store/journal_file.cpp: the table of the records has the last page. */
const TABLES = `
  CREATE TABLE session(id TEXT NOT NULL, scene TEXT NOT NULL, crc INTEGER NOT NULL,
                       base_folder TEXT NOT NULL, epoch INTEGER NOT NULL);
  CREATE TABLE participants(participant INTEGER PRIMARY KEY, name TEXT NOT NULL,
                            color TEXT NOT NULL, kind TEXT NOT NULL);
  CREATE TABLE state_hashes(sequence INTEGER PRIMARY KEY, hash INTEGER NOT NULL);
  CREATE TABLE kernel_versions(sequence INTEGER PRIMARY KEY, version INTEGER NOT NULL);
  CREATE TABLE agents(participant INTEGER PRIMARY KEY, token BLOB NOT NULL,
                      agent_sequence INTEGER NOT NULL, crc INTEGER NOT NULL);
  CREATE TABLE batches(first INTEGER PRIMARY KEY, count INTEGER NOT NULL,
                       wall_ms INTEGER NOT NULL, span_ms INTEGER NOT NULL, bytes BLOB NOT NULL,
                       crc INTEGER NOT NULL);
  PRAGMA application_id=${APPLICATION_ID};
  PRAGMA user_version=${VERSION};
`;
const TOOLS_TABLE = `CREATE TABLE IF NOT EXISTS tools(tool INTEGER PRIMARY KEY,
  record INTEGER NOT NULL, created_ms INTEGER NOT NULL, json TEXT NOT NULL, author TEXT NOT NULL,
  crc INTEGER NOT NULL)`;
const FILES_TABLE =
  'CREATE TABLE files(name TEXT PRIMARY KEY, bytes BLOB NOT NULL, crc INTEGER NOT NULL)';

function text(bytes: Uint8Array): string {
  return new TextDecoder().decode(bytes);
}

function begin(database: Database, { id, scene, sceneCrc, files }: JournalParts): void {
  database.run(TABLES);
  database.run('INSERT INTO session VALUES(?,?,?,?,1)', [text(id), text(scene), sceneCrc, '']);
  if (files.length > 0) database.run(FILES_TABLE);
  for (const { name, bytes, crc } of files)
    database.run('INSERT INTO files VALUES(?,?,?)', [text(name), bytes, crc]);
}

/** Adds the rows that the file lacks. */
function extend(database: Database, parts: JournalParts, people: readonly ParticipantInfo[]): void {
  const put = 'INSERT OR REPLACE INTO participants VALUES(?,?,?,?)';
  for (const { participant, name, color, kind } of people)
    database.run(put, [participant, name, color, kind]);
  const insert = database.prepare('INSERT OR IGNORE INTO batches VALUES(?,?,?,?,?,?)');
  for (const { first, count, wallMs, spanMs, bytes, crc } of rowsOf(parts.rows))
    insert.run([first, count, wallMs, spanMs, bytes, crc]);
  insert.free();
  if (parts.tools.length > 0) database.run(TOOLS_TABLE);
  for (const { tool, record, createdMs, json, crc } of parts.tools)
    database.run('INSERT OR IGNORE INTO tools VALUES(?,?,?,?,?,?)', [
      ...[tool, record, createdMs, json, ''],
      crc,
    ]);
  const { record, hash, kernelVersion } = parts;
  // The hash has 64 bits, more than a number here; SQLite stores a signed one.
  const signed = BigInt.asIntN(64, BigInt(`0x${hash}`)).toString();
  const putHash = 'INSERT OR REPLACE INTO state_hashes VALUES(?,CAST(? AS INTEGER))';
  database.run(putHash, [record, signed]);
  const last = 'SELECT version FROM kernel_versions ORDER BY sequence DESC LIMIT 1';
  database.run(`INSERT INTO kernel_versions SELECT ?,? WHERE ? IS NOT (${last})`, [
    record,
    kernelVersion,
    kernelVersion,
  ]);
}

/**
 * Returns the bytes of the file. `people`: the authors of its records but the session itself.
 * `before`: the file that the block was opened from, all of which stays; null: none. `writer`: of
 * the records since (record_origins.ts).
 */
export async function writeKerfFile(
  parts: JournalParts,
  people: readonly ParticipantInfo[],
  before: Uint8Array | null,
  writer: string,
): Promise<Uint8Array<ArrayBuffer>> {
  const database = await openDatabase(before);
  try {
    if (!before) begin(database, parts);
    beginWriter(database, writer);
    extend(database, parts, people);
    return new Uint8Array(database.export());
  } finally {
    database.close();
  }
}
