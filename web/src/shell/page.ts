// SPDX-License-Identifier: Apache-2.0
// Opens the page that the address names: a session, the lobby, an invitation.

import { installHook } from './hook';
import { watchPolicy } from '../link/forbidden';
import { invitationIn, redeemInvitation } from '../link/invitation';
import { viewerName } from '../link/viewer_name';
import { sentence } from '../ui/format';
import { frameLimit } from '../ui/frames';
import { t } from '../strings';
import { showFailure } from '../ui/notice';
import { showSessions } from './session_list';
import { SessionPage } from './session_page';

/** Removes parameters from the address of the page. */
function forgetParameters(parameters: URLSearchParams, names: readonly string[]): void {
  const kept = new URLSearchParams(parameters);
  for (const name of names) kept.delete(name);
  history.replaceState(null, '', `?${kept}`);
}

function openSession(app: HTMLElement, session: string, parameters: URLSearchParams): void {
  document.title = `${session} · Kerf`;
  watchPolicy();
  const fullQuality = parameters.get('quality') === 'full';
  const embedded = parameters.has('embed');
  const plays = parameters.has('play');
  const carves = parameters.has('carve');
  // Not again when the page is loaded again.
  if (plays || carves) forgetParameters(parameters, ['play', 'carve']);
  const name = viewerName(parameters);
  const page = new SessionPage({ app, session, name, fullQuality, embedded, plays, carves });
  installHook(page);
  page.start(frameLimit(parameters));
}

/** Shows the page of the address. */
export async function showPage(): Promise<void> {
  const app = document.getElementById('app')!;
  const parameters = new URLSearchParams(location.search);
  const session = parameters.get('session');
  if (!session && parameters.has('embed')) {
    const text = t('The address of an embedded page needs session=ID and embed.');
    showFailure(app, { title: t('No session chosen'), text });
    return;
  }
  const invitation = invitationIn(location.hash);
  // Before anything else: a token does not stay in the address, nor in the history.
  if (invitation !== null) history.replaceState(null, '', location.pathname + location.search);
  if (session) {
    const problem =
      invitation === null
        ? null
        : await redeemInvitation(session, invitation, viewerName(parameters));
    if (problem !== null) {
      showFailure(app, {
        title: t('This invitation does not work'),
        text: t('{0} Ask an owner of the session for a new link.', sentence(problem)),
      });
      return;
    }
    openSession(app, session, parameters);
    return;
  }
  const only = await showSessions(app, parameters.has('list'));
  if (only !== null) {
    history.replaceState(null, '', `?session=${encodeURIComponent(only)}`);
    openSession(app, only, parameters);
  }
}
