// SPDX-License-Identifier: Apache-2.0
// Addresses of the WebSockets of a session.

import { pathOf } from './strokes';

/** At the server that the page comes from. */
export function socketUrl(session: string, what: 'view' | 'agent'): string {
  const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
  return `${scheme}://${location.host}${pathOf(session, what)}`;
}
