// SPDX-License-Identifier: Apache-2.0
// The front page: the list of this server's sessions; skipped if there is only one.

import { InvitationNeeded, listSessions } from '../link/api';
import type { SessionSummary } from '../link/api';
import { h } from './dom';
import { count, volume } from './format';
import { failurePage } from './notice';

export function sessionUrl(id: string): string {
  return `?session=${encodeURIComponent(id)}`;
}

function card(session: SessionSummary): HTMLElement {
  const removed = volume(session.removedVolumeMm3).join(' ');
  const people = session.participants === 1 ? '1 person' : `${session.participants} people`;
  return h(
    'li',
    {},
    h(
      'a',
      { class: 'card', href: sessionUrl(session.id) },
      h('strong', {}, session.name),
      h('span', { class: 'quiet' }, session.id),
      h('span', {}, `${people} · ${count(session.motions)} motions · ${removed} removed`),
    ),
  );
}

/** Shows the list and returns null, or returns the id of the only session, unless `always`. */
export async function showSessions(app: HTMLElement, always: boolean): Promise<string | null> {
  let sessions: SessionSummary[];
  try {
    sessions = await listSessions();
  } catch (problem) {
    if (problem instanceof InvitationNeeded) {
      app.replaceChildren(failurePage('By invitation', problem.message, []));
      return null;
    }
    const text = `${(problem as Error).message} Check that kerf-server is running at this address.`;
    app.replaceChildren(failurePage('No connection', text, [{ label: 'Try again', href: '?' }]));
    return null;
  }
  if (sessions.length === 1 && !always) return sessions[0]!.id;
  const empty = sessions.length === 0;
  const lead = empty
    ? 'There are no sessions on this server.'
    : 'Sessions on this server. Choose one to watch.';
  const body = empty
    ? h(
        'p',
        {},
        'Start the server with a scene (',
        h('code', {}, 'kerf-server --scene scene.json'),
        ') or POST one to ',
        h('code', {}, '/v1/sessions'),
        '.',
      )
    : h('ul', { class: 'cards' }, ...sessions.map(card));
  app.replaceChildren(
    h('main', { class: 'page' }, h('h1', {}, 'Kerf'), h('p', { class: 'lead' }, lead), body),
  );
  return null;
}
