// SPDX-License-Identifier: Apache-2.0
// The last strokes by hand in the browser's own storage (IndexedDB), as a .kerf file, until the user
// has saved or given them up: a page that is loaded again offers them.

const DATABASE = 'kerf';
const STORE = 'autosave';
const KEY = 'last';

export interface KeptStrokes {
  /** Of the file. */
  name: string;
  bytes: Uint8Array<ArrayBuffer>;
  /** When they were kept, ms since 1970. */
  atMs: number;
}

function answer<T>(request: IDBRequest<T>): Promise<T> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error ?? new Error('the browser stores nothing'));
  });
}

async function inStore<T>(
  mode: IDBTransactionMode,
  act: (store: IDBObjectStore) => IDBRequest<T>,
): Promise<T> {
  const opening = indexedDB.open(DATABASE, 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore(STORE);
  const database = await answer(opening);
  try {
    return await answer(act(database.transaction(STORE, mode).objectStore(STORE)));
  } finally {
    database.close();
  }
}

/** All functions reject where the browser stores nothing. */
export async function keepStrokes(strokes: KeptStrokes): Promise<void> {
  await inStore('readwrite', (store) => store.put(strokes, KEY));
}

export async function keptStrokes(): Promise<KeptStrokes | null> {
  const kept = await inStore<unknown>('readonly', (store) => store.get(KEY));
  return (kept as KeptStrokes | undefined) ?? null;
}

export async function forgetStrokes(): Promise<void> {
  await inStore('readwrite', (store) => store.delete(KEY));
}
