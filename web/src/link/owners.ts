// SPDX-License-Identifier: Apache-2.0
// Asks who cut the surface at many points, and who all those are.

import type { Author } from '../model/participants';
import { ask } from './server_error';
import { pathOf } from './address';

/** Points of one request, so that one who undoes does not wait long for its answer. */
export const OWNER_POINTS_MAX = 16_384;
/** Place and normal. */
export const OWNER_NUMBERS = 6;

/**
 * Returns the participant that cut the surface at each point, 0 where it is that of the stock.
 * @param points X, Y and Z of each, and those of the normal there
 * @param record after which the block is looked at; null: as it is
 */
export async function ownersAt(
  session: string,
  points: Float32Array<ArrayBuffer>,
  record: number | null,
  signal: AbortSignal,
): Promise<Uint32Array> {
  const query = record === null ? '' : `?at=${record}`;
  const response = await ask('POST', pathOf(session, `owners${query}`), points, signal);
  return new Uint32Array(await response.arrayBuffer());
}

function isAuthor(value: unknown): value is Author {
  if (typeof value !== 'object' || value === null) return false;
  const { participant, name, color } = value as Record<string, unknown>;
  return (
    Number.isInteger(participant) &&
    typeof name === 'string' &&
    typeof color === 'string' &&
    /^#[0-9a-f]{6}$/i.test(color)
  );
}

/** Rejects with a ServerError. */
export async function listAuthors(session: string): Promise<Author[]> {
  const response = await ask('GET', pathOf(session, 'authors'));
  const { authors } = (await response.json()) as { authors?: unknown };
  return Array.isArray(authors) ? authors.filter(isAuthor) : [];
}
