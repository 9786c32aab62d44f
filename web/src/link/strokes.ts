// SPDX-License-Identifier: Apache-2.0
// Requests that list strokes, undo and redo them.

import { t } from '../strings';
import type { Stroke, StrokeChange } from '../model/stroke';
import { pathOf } from './address';
import { noAnswer, request } from './request';

async function reasonOf(response: Response): Promise<string> {
  const body = (await response.json().catch(() => null)) as {
    error?: { reason?: unknown };
  } | null;
  const reason = body?.error?.reason;
  return typeof reason === 'string' ? reason : t('the server reported error {0}', response.status);
}

async function answerOf(path: string, method: string, body?: string): Promise<Response> {
  const sent = body === undefined ? {} : { body };
  const response = await request(path, { method, ...sent }).catch(() => {
    throw new Error(noAnswer());
  });
  if (!response.ok) throw new Error(await reasonOf(response));
  return response;
}

/** Asks the server; rejects with a sentence that says why it did not answer, or not so. */
export async function ask(path: string, method: string, body?: string): Promise<unknown> {
  return (await answerOf(path, method, body)).json();
}

/** The same for an answer that is no JSON. */
export async function askBytes(path: string): Promise<Uint8Array<ArrayBuffer>> {
  return new Uint8Array(await (await answerOf(path, 'GET')).arrayBuffer());
}

function isStroke(value: unknown): value is Stroke {
  if (typeof value !== 'object' || value === null) return false;
  const from = value as Record<string, unknown>;
  const numbers = ['id', 'last', 'participant', 'tool', 'motions', 'begin_ms', 'end_ms'];
  return (
    numbers.every((name) => Number.isFinite(from[name])) && typeof from['undone'] === 'boolean'
  );
}

/**
 * Returns the strokes of a session that begin at the record `since` or later, oldest first. Rejects,
 * as changeStrokes does, with an error whose message says why.
 */
export async function listStrokes(session: string, since = 0): Promise<Stroke[]> {
  const body = (await ask(pathOf(session, `strokes?since=${since}`), 'GET')) as {
    strokes?: unknown;
  };
  return Array.isArray(body.strokes) ? body.strokes.filter(isStroke) : [];
}

/** Undoes or redoes a stroke; resolves when the block has changed, or will once the disk allows. */
export async function changeStroke(
  session: string,
  change: StrokeChange,
  stroke: number,
): Promise<void> {
  await ask(pathOf(session, `${change}?strokes=${stroke}`), 'POST');
}
