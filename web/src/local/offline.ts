// SPDX-License-Identifier: Apache-2.0
// Keeps the files of the page in the browser, so that it opens without a network. A newer build is
// kept while the page runs.

/** Whether the page is one file, which needs no other. */
declare const KERF_IS_SINGLE: boolean;

const CACHE = 'kerf-';

interface Build {
  version: string;
  files: string[];
}

/** A request that revalidates the browser's cached copy with the host. */
const fromHost = (path: string): Request => new Request(path, { cache: 'no-cache' });

/** Keeps all files of the newest build, then forgets those of earlier ones. */
export async function keepBuild(): Promise<void> {
  const answer = await fetch(fromHost('./offline.json'));
  if (!answer.ok) return;
  const { version, files } = (await answer.json()) as Build;
  const name = CACHE + version;
  if (await caches.has(name)) return;
  const cache = await caches.open(name);
  try {
    await cache.addAll(files.map((file) => fromHost(`./${file}`)));
  } catch (problem) {
    await caches.delete(name); // a part of a build is of no use
    throw problem;
  }
  const others = (await caches.keys()).filter((key) => key.startsWith(CACHE) && key !== name);
  await Promise.all(others.map((key) => caches.delete(key)));
}

/** Has the page open without a network from now on, where the browser and the host permit it. */
export async function worksOffline(): Promise<void> {
  if (KERF_IS_SINGLE || !('serviceWorker' in navigator)) return;
  try {
    await navigator.serviceWorker.register('./offline.js');
    if (navigator.onLine) await keepBuild();
  } catch (problem) {
    console.warn('The page will not open without a network:', problem);
  }
}
