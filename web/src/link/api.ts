// SPDX-License-Identifier: Apache-2.0
// HTTP requests of the viewer: the list of sessions, and whether a session exists.

import { t } from '../strings';

export interface SessionSummary {
  id: string;
  name: string;
  motions: number;
  removedVolumeMm3: number;
  participants: number;
  /** When block or participants changed last; null if the server does not know. */
  activeMs: number | null;
}

const INVITATION_NEEDED = t('Open the link of an invitation: this server lets nobody else in.');

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
  };
}

/**
 * Lists all sessions of this server. Rejects with an error whose message is a sentence for the
 * user.
 */
export async function listSessions(): Promise<SessionSummary[]> {
  const response = await fetch('/v1/sessions', { headers: { accept: 'application/json' } }).catch(
    () => {
      throw new Error(t('The server did not answer.'));
    },
  );
  if (response.status === 401) throw new InvitationNeeded();
  if (!response.ok)
    throw new Error(t('The server answered {0} {1}.', response.status, response.statusText));
  const body: unknown = await response.json().catch(() => {
    throw new Error(t('The server did not answer with a list of sessions.'));
  });
  const list = Array.isArray(body) ? body : (body as { sessions?: unknown } | null)?.sessions;
  if (!Array.isArray(list))
    throw new Error(t('The server did not answer with a list of sessions.'));
  return list.map(summaryOf).filter((summary) => summary !== null);
}

/**
 * Returns why a session can never be joined, as a sentence for the user; null if a retry may
 * succeed.
 */
export async function probeSession(id: string): Promise<string | null> {
  try {
    const response = await fetch(`/v1/sessions/${encodeURIComponent(id)}`);
    if (response.status === 401) return INVITATION_NEEDED;
    return response.status === 404 ? t('There is no session “{0}” on this server.', id) : null;
  } catch {
    return null; // the server is unreachable, perhaps only for now
  }
}
