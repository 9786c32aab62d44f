// SPDX-License-Identifier: Apache-2.0
// Addresses of a session.

import { socketOrigin } from './request';

export function pathOf(session: string, what: string): string {
  return `/v1/sessions/${encodeURIComponent(session)}/${what}`;
}

/** Of a WebSocket, at the server that requests go to. */
export function socketUrl(session: string, what: 'view' | 'agent'): string {
  return socketOrigin() + pathOf(session, what);
}
