// SPDX-License-Identifier: Apache-2.0
// Requests for the journal of a session, which the page replays by itself. Origin and spans never
// change, so that caches answer most of them.

import { pathOf } from './address';
import { ask, askBytes } from './strokes';

/** Spans begin and end where everybody's do, so that they are in the caches. */
export const SPAN_RECORDS = 32_768;

/** The present of a session. */
export interface ReplayState {
  /** The journal's name in the other requests. */
  journal: string;
  /** Its last record, and the state hash after it. */
  record: number;
  state_hash: string;
}

export interface Span {
  first: number;
  last: number;
}

/** The spans that hold the records after one, to another. */
export function spansOf(after: number, to: number): Span[] {
  const spans: Span[] = [];
  for (let at = after; at < to;) {
    const first = Math.floor(at / SPAN_RECORDS) * SPAN_RECORDS + 1;
    const last = Math.min(first + SPAN_RECORDS - 1, to);
    spans.push({ first, last });
    at = last;
  }
  return spans;
}

/**
 * The present of a session, or how the server replays it to a record. All functions reject with a
 * sentence that says why.
 */
export async function replayState(session: string, at?: number): Promise<ReplayState> {
  const what = at === undefined ? 'replay' : `replay?at=${at}`;
  const body = (await ask(pathOf(session, what), 'GET')) as Record<string, unknown>;
  return {
    journal: String(body['journal']),
    record: Number(body['record']),
    state_hash: String(body['state_hash']),
  };
}

/** The start of a journal: its scene, and the files that the scene names. */
export function journalOrigin(session: string, journal: string): Promise<Uint8Array<ArrayBuffer>> {
  return askBytes(pathOf(session, `origin?journal=${journal}`));
}

/** The records after one, to another, in spans that may begin earlier. */
export async function journalRecords(
  session: string,
  journal: string,
  after: number,
  to: number,
): Promise<Uint8Array<ArrayBuffer>[]> {
  const bytes: Uint8Array<ArrayBuffer>[] = [];
  for (const { first, last } of spansOf(after, to)) {
    const path = `records?journal=${journal}&first=${first}&last=${last}`;
    bytes.push(await askBytes(pathOf(session, path)));
  }
  return bytes;
}

/** State hashes that the server stored as it carved, of records from one to another. */
export async function storedHashes(
  session: string,
  journal: string,
  first: number,
  last: number,
): Promise<{ record: number; hash: string }[]> {
  if (last < first) return [];
  const path = `hashes?journal=${journal}&first=${first}&last=${last}`;
  const { hashes } = (await ask(pathOf(session, path), 'GET')) as {
    hashes: { record: number; state_hash: string }[];
  };
  return hashes.map(({ record, state_hash }) => ({ record, hash: state_hash }));
}
