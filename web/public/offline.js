// SPDX-License-Identifier: Apache-2.0
// The service worker of kerf.html: without a network it answers from the files that the page has
// kept (src/local/offline.ts). With a network it answers nothing, because the policy of a script's
// file may forbid it to fetch (server/http), and pages of sessions have files that nobody keeps.

const asksHost = ({ method, url }) =>
  method !== 'GET' || navigator.onLine || new URL(url).origin !== location.origin;

self.addEventListener('install', () => self.skipWaiting());
self.addEventListener('activate', (event) => event.waitUntil(self.clients.claim()));
self.addEventListener('fetch', (event) => {
  const { request } = event;
  if (asksHost(request)) return;
  const kept = caches.match(request, { ignoreSearch: true, ignoreVary: true });
  event.respondWith(kept.then((answer) => answer ?? fetch(request)));
});
