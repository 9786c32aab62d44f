// SPDX-License-Identifier: Apache-2.0
// The server that answers the page's requests: the one that the page comes from, until another one
// goes on with the session.

import { t } from '../strings';

let server = ''; // an origin; empty: that of the page

/** Requests go to the server with this origin from now on, those of new hands too. */
export function useServer(origin: string): void {
  server = origin === location.origin ? '' : origin;
}

/** The address of a path at the server. */
export function addressOf(path: string): string {
  return server + path;
}

/** Of the WebSockets at the server, such as `ws://host:8080`. */
export function socketOrigin(): string {
  return (server || location.origin).replace(/^http/, 'ws');
}

/** The address at which this page, or with another query, can be loaded again. */
export function pageAddress(search = location.search): string {
  return `${server || location.origin}${location.pathname}${search}`;
}

/** As fetch. The pass of an invitation goes to another server too, where the browser has one for it. */
export function request(path: string, init: RequestInit = {}): Promise<Response> {
  return fetch(addressOf(path), { ...init, credentials: 'include' });
}

/** Says that a chunk of the page's code did not come: it is only at the server of the page. */
export function notLoaded(): string {
  const { origin } = location;
  if (server === '')
    return t(
      'This part of the page did not load because {0} does not answer. Try again later.',
      origin,
    );
  return t(
    'This part of the page did not load because {0} does not answer. Open the page at {1}.',
    origin,
    server,
  );
}

/** Why a request got no answer: a sentence. Browsers do not tell who has refused it. */
export function noAnswer(): string {
  if (server === '') return t('The server did not answer.');
  return t(
    '{0} did not answer, or refuses pages from {1}. Open the page there instead.',
    server,
    location.origin,
  );
}
