// SPDX-License-Identifier: Apache-2.0
// HTTP requests of the viewer: the list of sessions, and whether a session exists.

import { t } from '../strings';
import { isForbidden } from './forbidden';
import { noAnswer, request } from './request';

export interface SessionSummary {
  id: string;
  name: string;
  motions: number;
  removedVolumeMm3: number;
  participants: number;
  /** When block or participants changed last; null if the server does not know. */
  activeMs: number | null;
  /** The rights of the viewer. */
  mayRename: boolean;
  mayClose: boolean;
}

const INVITATION_NEEDED = t('This server is by invitation only. Open the link you were sent.');

/** The server tells its sessions only to people who were invited. */
export class InvitationNeeded extends Error {
  constructor() {
    super(INVITATION_NEEDED);
  }
}

function numberOr(value: unknown, otherwise: number): number {
  return typeof value === 'number' && Number.isFinite(value) ? value : otherwise;
}

function summaryOf(value: unknown): SessionSummary | null {
  if (typeof value !== 'object' || value === null) return null;
  const from = value as Record<string, unknown>;
  const id = from['id'] ?? from['session'];
  if (typeof id !== 'string') return null;
  const people = from['participants'];
  return {
    id,
    name: typeof from['name'] === 'string' && from['name'] !== '' ? from['name'] : id,
    motions: numberOr(from['motions'], 0),
    removedVolumeMm3: numberOr(from['removed_volume_mm3'], 0),
    participants: Array.isArray(people) ? people.length : numberOr(people, 0),
    activeMs: typeof from['active_ms'] === 'number' ? from['active_ms'] : null,
    mayRename: from['may_rename'] === true,
    mayClose: from['may_close'] === true,
  };
}

/**
 * Lists all sessions of this server. Rejects with an error whose message is a sentence for the
 * user.
 */
export async function listSessions(): Promise<SessionSummary[]> {
  const headers = { accept: 'application/json' };
  const response = await request('/v1/sessions', { headers }).catch(() => {
    throw new Error(noAnswer());
  });
  if (response.status === 401) throw new InvitationNeeded();
  if (!response.ok)
    throw new Error(
      t('The server reported an error: {0} {1}.', response.status, response.statusText),
    );
  const body: unknown = await response.json().catch(() => {
    throw new Error(t('The server did not send a list of sessions.'));
  });
  const list = Array.isArray(body) ? body : (body as { sessions?: unknown } | null)?.sessions;
  if (!Array.isArray(list)) throw new Error(t('The server did not send a list of sessions.'));
  return list.map(summaryOf).filter((summary) => summary !== null);
}

/** The reason of a server that does not let the page join a session. */
export interface Rejection {
  /** Why nothing else can be tried: a sentence for the user. Missing: a retry may succeed. */
  final?: string;
  /** Whether only a page of that server itself may be let in, with a pass that it has. */
  isForItsPage?: boolean;
}

/** Whether a server answers, though the browser hides what from this page. */
async function hidesAnswers(address: string): Promise<boolean> {
  return fetch(address, { mode: 'no-cors' }).then(
    () => true,
    () => false, // unreachable, perhaps only for now
  );
}

/** Asks the server with this origin why it does not let the page join a session. */
export async function probeSession(id: string, server: string): Promise<Rejection> {
  const address = `${server}/v1/sessions/${encodeURIComponent(id)}`;
  const isOwn = server === location.origin;
  const response = await fetch(address, { credentials: 'include' }).catch(() => null);
  if (response?.status === 404)
    return { final: t('There is no session “{0}” on this server.', id) };
  if (response?.status === 401)
    return isOwn ? { final: INVITATION_NEEDED } : { isForItsPage: true };
  if (response || isOwn) return {};
  return { isForItsPage: isForbidden(server) || (await hidesAnswers(address)) };
}
