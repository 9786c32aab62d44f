// SPDX-License-Identifier: Apache-2.0
// The service worker of kerf.html: answers from the files that the page has kept
// (src/local/offline.ts), so that it opens without a network. It fetches those only that the page
// does not keep, because the policy of a script's file may forbid it (server/http).

/** Where the page looks for a newer build, its requests go to the host. */
const asksHost = ({ method, headers, url }) =>
  method !== 'GET' || headers.has('kerf-host') || new URL(url).origin !== location.origin;

self.addEventListener('install', () => self.skipWaiting());
self.addEventListener('activate', (event) => event.waitUntil(self.clients.claim()));
self.addEventListener('fetch', (event) => {
  const { request } = event;
  if (asksHost(request)) return;
  const kept = caches.match(request, { ignoreSearch: true, ignoreVary: true });
  event.respondWith(kept.then((answer) => answer ?? fetch(request)));
});
