// SPDX-License-Identifier: Apache-2.0
// The front page: the list of this server's sessions; skipped if there is only one.

import { t } from '../strings';
import { InvitationNeeded, listSessions } from '../link/api';
import type { SessionSummary } from '../link/api';
import { showFailure } from '../ui/notice';

/** Shows the list and returns null, or returns the id of the only session, unless `always`. */
export async function showSessions(app: HTMLElement, always: boolean): Promise<string | null> {
  let sessions: SessionSummary[];
  try {
    sessions = await listSessions();
  } catch (problem) {
    if (problem instanceof InvitationNeeded) {
      showFailure(app, { title: t('By invitation only'), text: problem.message });
      return null;
    }
    const text = t(
      '{0} Check that kerf-server is running at this address.',
      (problem as Error).message,
    );
    const actions = [{ label: t('Try again'), href: '?' }];
    showFailure(app, { title: t('No connection'), text, actions });
    return null;
  }
  if (sessions.length === 1 && !always) return sessions[0]!.id;
  const { showLobby } = await import('../ui/lobby/lobby');
  showLobby(app, sessions);
  return null;
}
