// SPDX-License-Identifier: Apache-2.0
// Finds the record at which two replays of a journal part: those of the server and of the page.

import type { HashAt } from './replayer';

/** The server's hashes of a journal. */
export interface ServerHashes {
  /** Those that it has stored, about one a second, of records from one to another; not all if many. */
  stored: (first: number, last: number) => Promise<HashAt[]>;
  /** By its own replay to a record. */
  replayed: (record: number) => Promise<string>;
}

/** The page's replay, at its beginning. */
export interface OwnHashes {
  carve: (to: number) => Promise<HashAt>;
  seek: (record: number) => Promise<HashAt>;
}

/** Equal after record `after`, and different after record `by`, the next one if that was found. */
export interface Difference {
  after: number;
  by: number;
}

type Go = (record: number) => Promise<HashAt>;

/** Goes along hashes until one differs. Returns the last equal one and the first other one. */
async function scan(
  hashes: readonly HashAt[],
  go: Go,
  after: number,
): Promise<{ equal: number; other: HashAt | null }> {
  let equal = after;
  for (const expected of hashes) {
    const { record, hash } = await go(expected.record);
    if (record !== expected.record || hash !== expected.hash) return { equal, other: expected };
    equal = expected.record;
  }
  return { equal, other: null };
}

/**
 * Finds the first stored hash that differs, and the record before it at which the server's own
 * replay and the page's part; not the latter where the server's replay is the page's.
 * @param last the server's present state, which differs from the page's
 */
export async function firstDifference(
  server: ServerHashes,
  own: OwnHashes,
  last: HashAt,
): Promise<Difference> {
  const stored = await server.stored(1, last.record - 1);
  let { equal, other } = await scan([...stored, last], (to) => own.carve(to), 0);
  let by = other ?? last;
  // Between the hashes of a long journal there are others.
  for (;;) {
    const between = by.record - equal > 1 ? await server.stored(equal + 1, by.record - 1) : [];
    if (between.length === 0) break;
    ({ equal, other } = await scan(between, (to) => own.seek(to), equal));
    by = other ?? by;
  }
  return parting(server, own, equal, by);
}

/** Halves the records between. */
async function parting(
  server: ServerHashes,
  own: OwnHashes,
  equal: number,
  other: HashAt,
): Promise<Difference> {
  const differsAt = async (record: number): Promise<boolean> =>
    (await own.seek(record)).hash !== (await server.replayed(record));
  let [after, by] = [equal, other.record];
  if (by - after > 1 && !(await differsAt(by))) return { after, by };
  while (by - after > 1) {
    const middle = Math.floor((after + by) / 2);
    if (await differsAt(middle)) by = middle;
    else after = middle;
  }
  return { after, by };
}
