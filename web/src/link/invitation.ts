// SPDX-License-Identifier: Apache-2.0
// Invitations: taking one from the address, exchanging it for a pass, and making new ones. A pass is
// a cookie that scripts cannot read, so that no token stays in the page.

import { t } from '../strings';
import { noAnswer, pageAddress, request } from './request';

export type InvitedRole = 'watcher' | 'sculptor' | 'owner';

interface Problem {
  error?: { reason?: unknown };
}

async function reasonOf(response: Response): Promise<string> {
  const body = (await response.json().catch(() => null)) as Problem | null;
  const reason = body?.error?.reason;
  return typeof reason === 'string' ? reason : t('the server reported error {0}', response.status);
}

function pathOf(session: string, what: string): string {
  return `/v1/sessions/${encodeURIComponent(session)}/${what}`;
}

/**
 * Returns the token in the fragment of an invitation's link; null if there is none. Browsers send
 * the fragment to nobody.
 */
export function invitationIn(hash: string): string | null {
  const token = new URLSearchParams(hash.replace(/^#/, '')).get('invite');
  return token !== null && /^kerf_[0-9a-f]+_[0-9a-f]+$/.test(token) ? token : null;
}

/**
 * Exchanges an invitation for a pass, which the browser keeps. Returns null, or, as a sentence for
 * the user, why that failed.
 */
export async function redeemInvitation(
  session: string,
  token: string,
  name: string,
): Promise<string | null> {
  const address = `${pathOf(session, 'join')}?name=${encodeURIComponent(name)}`;
  const response = await request(address, {
    method: 'POST',
    headers: { authorization: `Bearer ${token}` },
  }).catch(() => null);
  if (!response) return noAnswer();
  return response.ok ? null : reasonOf(response);
}

/**
 * Makes an invitation that lasts for `hours` and returns its link. Rejects with an error whose
 * message is a sentence for the user.
 */
export async function makeInvitation(
  session: string,
  role: InvitedRole,
  hours: number,
): Promise<string> {
  const address = `${pathOf(session, 'invitations')}?role=${role}&hours=${hours}`;
  const response = await request(address, { method: 'POST' }).catch(() => {
    throw new Error(noAnswer());
  });
  if (!response.ok) throw new Error(await reasonOf(response));
  const body = (await response.json()) as { link?: unknown };
  if (typeof body.link !== 'string') throw new Error(t('The server sent no link. Try again.'));
  return new URL(body.link, pageAddress()).href;
}
