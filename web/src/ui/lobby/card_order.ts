// SPDX-License-Identifier: Apache-2.0
// Which sessions the lobby shows, and in which order.

import type { SessionSummary } from '../../link/api';

/** By the time of the last change, the latest first, or by the name. */
export type Order = 'active' | 'name';

/** Returns the sessions whose names contain the text, in any case. */
export function shownSessions(
  sessions: readonly SessionSummary[],
  search: string,
  order: Order,
): SessionSummary[] {
  const wanted = search.trim().toLocaleLowerCase();
  const found = sessions.filter(({ name }) => name.toLocaleLowerCase().includes(wanted));
  const byName = (a: SessionSummary, b: SessionSummary): number =>
    a.name.localeCompare(b.name, undefined, { numeric: true });
  const byTime = (a: SessionSummary, b: SessionSummary): number =>
    (b.activeMs ?? 0) - (a.activeMs ?? 0);
  return found.sort(order === 'name' ? byName : byTime);
}
