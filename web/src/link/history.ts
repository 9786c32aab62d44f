// SPDX-License-Identifier: Apache-2.0
// Requests about the history of a session: named versions, branches, forces along the journal.

import { ask, pathOf } from './strokes';

/** A name for the block as it was after a record. */
export interface Version {
  name: string;
  record: number;
  /** When the record was appended, ms since 1970; 0: unknown. */
  time_ms: number;
  /** Empty: unknown. */
  author: string;
  /** Whether this viewer may rename and delete it. */
  may_change: boolean;
}

/** Forces of equal spans of records: columns of equal length. */
export interface ForceCurve {
  first: number[];
  last: number[];
  minN: number[];
  meanN: number[];
  maxN: number[];
}

function isVersion(value: unknown): value is Version {
  if (typeof value !== 'object' || value === null) return false;
  const { name, record, time_ms, author, may_change } = value as Record<string, unknown>;
  return (
    typeof name === 'string' &&
    typeof author === 'string' &&
    typeof may_change === 'boolean' &&
    Number.isFinite(record) &&
    Number.isFinite(time_ms)
  );
}

/** Lists the named versions, by their records. All functions reject with a sentence that says why. */
export async function listVersions(session: string): Promise<Version[]> {
  const { versions } = (await ask(pathOf(session, 'versions'), 'GET')) as { versions?: unknown };
  if (!Array.isArray(versions)) return [];
  return versions.filter(isVersion).sort((a, b) => a.record - b.record);
}

/** Names the block as it was after a record; null: as it is. */
export async function nameVersion(
  session: string,
  name: string,
  record: number | null,
): Promise<void> {
  const at = record === null ? '' : `&at=${record}`;
  await ask(pathOf(session, `versions?name=${encodeURIComponent(name)}${at}`), 'POST');
}

/** Gives a version another name; its author and times stay. */
export async function renameVersion(session: string, name: string, to: string): Promise<void> {
  const path = `versions/${encodeURIComponent(name)}?name=${encodeURIComponent(to)}`;
  await ask(pathOf(session, path), 'PATCH');
}

export async function deleteVersion(session: string, name: string): Promise<void> {
  await ask(pathOf(session, `versions/${encodeURIComponent(name)}`), 'DELETE');
}

/** Makes a session that begins as this one was after a record; null: as it is. Returns its id. */
export async function branch(session: string, record: number | null, id: string): Promise<string> {
  const from = encodeURIComponent(record === null ? session : `${session}@${record}`);
  const made = (await ask(`/v1/sessions?from=${from}&id=${encodeURIComponent(id)}`, 'POST')) as {
    id?: unknown;
  };
  return typeof made.id === 'string' ? made.id : id;
}

/** The forces of the whole journal in at most `points` spans. */
export async function forceCurve(session: string, points: number): Promise<ForceCurve> {
  const body = (await ask(pathOf(session, `forces?points=${points}`), 'GET')) as Record<
    string,
    unknown
  >;
  const force = (body['force_n'] ?? {}) as Record<string, unknown>;
  const columns = [body['first'], body['last'], force['min'], force['mean'], force['max']];
  const [first = [], last = [], minN = [], meanN = [], maxN = []] = columns.map((column) =>
    Array.isArray(column) ? column.map(Number) : [],
  );
  const count = Math.min(...[first, last, minN, meanN, maxN].map(({ length }) => length));
  const cut = (column: number[]): number[] => column.slice(0, count);
  return {
    first: cut(first),
    last: cut(last),
    minN: cut(minN),
    meanN: cut(meanN),
    maxN: cut(maxN),
  };
}
