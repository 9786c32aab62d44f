// SPDX-License-Identifier: Apache-2.0
// Errors of the server's HTTP interface.

import { t } from '../strings';
import { noAnswer, request } from './request';

/** Why the server rejected a request: one sentence, and the place of the fault if it has one. */
export class ServerError extends Error {
  constructor(
    message: string,
    /** Of a program. */
    readonly line = 0,
    readonly word = '',
    readonly status = 0,
    /** Of a scene, e.g. "tools[0].diameter_mm". */
    readonly path = '',
    /** What kind of error it is, e.g. "not_closed". */
    readonly code = '',
  ) {
    super(message);
  }
}

function textOf(value: unknown): string {
  return typeof value === 'string' ? value : '';
}

export async function errorOf(response: Response): Promise<ServerError> {
  const body = (await response.json().catch(() => null)) as {
    error?: Record<string, unknown>;
  } | null;
  const error = body?.error ?? {};
  const reason = textOf(error['reason']);
  const { status, statusText } = response;
  return new ServerError(
    reason === '' ? t('The server reported an error: {0} {1}.', status, statusText) : reason,
    typeof error['line'] === 'number' ? error['line'] : 0,
    textOf(error['word']),
    status,
    textOf(error['path']),
    textOf(error['code']),
  );
}

/** Rejects with a ServerError unless the answer is a success. */
export async function ask(
  method: string,
  path: string,
  body: BodyInit | null = null,
  signal: AbortSignal | null = null,
): Promise<Response> {
  const response = await request(path, { method, body, signal }).catch((problem: unknown) => {
    if (signal?.aborted) throw problem;
    throw new ServerError(noAnswer());
  });
  if (!response.ok) throw await errorOf(response);
  return response;
}
