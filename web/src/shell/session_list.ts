// SPDX-License-Identifier: Apache-2.0
// The front page: the list of this server's sessions; skipped if there is only one.

import { t } from '../strings';
import { InvitationNeeded, listSessions } from '../link/api';
import type { SessionSummary } from '../link/api';
import { failurePage } from '../ui/notice';

/** Shows the list and returns null, or returns the id of the only session, unless `always`. */
export async function showSessions(app: HTMLElement, always: boolean): Promise<string | null> {
  let sessions: SessionSummary[];
  try {
    sessions = await listSessions();
  } catch (problem) {
    if (problem instanceof InvitationNeeded) {
      app.replaceChildren(failurePage(t('By invitation only'), problem.message, []));
      return null;
    }
    const text = t(
      '{0} Check that kerf-server is running at this address.',
      (problem as Error).message,
    );
    app.replaceChildren(
      failurePage(t('No connection'), text, [{ label: t('Try again'), href: '?' }]),
    );
    return null;
  }
  if (sessions.length === 1 && !always) return sessions[0]!.id;
  const { Lobby } = await import('../ui/lobby/lobby');
  new Lobby(app, sessions);
  return null;
}
