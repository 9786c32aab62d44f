// SPDX-License-Identifier: Apache-2.0
// Addresses of a session.

export function pathOf(session: string, what: string): string {
  return `/v1/sessions/${encodeURIComponent(session)}/${what}`;
}

/** Of a WebSocket, at the server that the page comes from. */
export function socketUrl(session: string, what: 'view' | 'agent'): string {
  const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
  return `${scheme}://${location.host}${pathOf(session, what)}`;
}
