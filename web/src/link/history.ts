// SPDX-License-Identifier: Apache-2.0
// Requests about the history of a session: named versions, branches, forces along the journal.

import { pathOf } from './address';
import type { ForceCurve } from '../model/force_curve';
import { peaksOf } from '../model/wrench_path';
import { ask } from './strokes';

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

/** Motions of one participant. */
export interface MotionsOf {
  participant: number;
  from: number;
  to: number;
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

/** The forces of the whole journal, or of some motions, in at most `points` spans. */
export async function forceCurve(
  session: string,
  points: number,
  of?: MotionsOf,
): Promise<ForceCurve> {
  const only = of ? `&participant=${of.participant}&from=${of.from}&to=${of.to}` : '';
  const body = (await ask(pathOf(session, `forces?points=${points}${only}`), 'GET')) as Record<
    string,
    unknown
  >;
  const force = (body['force_n'] ?? {}) as Record<string, unknown>;
  const given = [body['first'], body['last'], force['min'], force['mean'], force['max']];
  const columns = [...given, body['end_s'], body['removed_mm3'], body['motions']].map((column) =>
    Array.isArray(column) ? column.map(Number) : [],
  );
  const count = Math.min(...columns.map(({ length }) => length));
  const cut = (n: number): number[] => columns[n]!.slice(0, count);
  return {
    first: cut(0),
    last: cut(1),
    minN: cut(2),
    meanN: cut(3),
    maxN: cut(4),
    endS: cut(5),
    removedMm3: cut(6),
    motions: cut(7),
    peaks: peaksOf(body),
  };
}
