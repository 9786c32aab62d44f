// SPDX-License-Identifier: Apache-2.0
// Fetches a file of a session and tells how far that is.

import { lossesIn, nameIn } from '../model/take_home';
import { ask } from './server_error';

const POLL_MS = 400;

/** The server makes the file, then it comes. `share`: 0 to 1; null while it is not known. */
export interface Progress {
  phase: 'making' | 'coming';
  share: number | null;
  bytes: number;
}

export interface TakenFile {
  name: string;
  content: Blob;
  /** The losses of a surface. */
  losses: string[];
}

interface Making {
  name?: unknown;
  share?: unknown;
}

/** The share of a file that the server has made; null if it is not making it. */
async function shareMade(
  folder: string,
  file: string,
  signal: AbortSignal,
): Promise<number | null> {
  const body = (await (await ask('GET', `${folder}/exports`, null, signal)).json()) as {
    exports?: Making[];
  };
  const plain = file.replace(/\?.*$/, '');
  const found = (body.exports ?? []).find(({ name }) => name === plain);
  return typeof found?.share === 'number' ? found.share : null;
}

async function read(
  response: Response,
  progress: (progress: Progress) => void,
): Promise<BlobPart[]> {
  const length = Number(response.headers.get('content-length') ?? 0);
  const parts: BlobPart[] = [];
  const reader = response.body!.getReader();
  for (let bytes = 0; ;) {
    const { done, value } = await reader.read();
    if (done) return parts;
    parts.push(value);
    bytes += value.byteLength;
    progress({ phase: 'coming', share: length > 0 ? bytes / length : null, bytes });
  }
}

/**
 * Fetches a file of a session. When `signal` aborts, the server stops making it, and the promise
 * rejects with the signal's reason. Else rejects with a ServerError.
 */
export async function takeHome(
  session: string,
  file: string,
  signal: AbortSignal,
  progress: (progress: Progress) => void,
): Promise<TakenFile> {
  const folder = `/v1/sessions/${encodeURIComponent(session)}`;
  progress({ phase: 'making', share: null, bytes: 0 });
  let isMaking = true;
  const poll = setInterval(() => {
    shareMade(folder, file, signal).then(
      (share) => isMaking && progress({ phase: 'making', share, bytes: 0 }),
      () => undefined, // the request for the file itself reports the error
    );
  }, POLL_MS);
  const made = (): void => {
    isMaking = false;
    clearInterval(poll);
  };
  try {
    const response = await ask('GET', `${folder}/${file}`, null, signal);
    made();
    const parts = await read(response, progress);
    const name = nameIn(response.headers.get('content-disposition') ?? '');
    return {
      name: name === '' ? file.replace(/\?.*$/, '') : name,
      content: new Blob(parts),
      losses: lossesIn(response.headers.get('kerf-model') ?? ''),
    };
  } finally {
    made();
  }
}
