// SPDX-License-Identifier: Apache-2.0
// The address at which another server goes on with a session.

/**
 * Returns the address to which the page at `page` goes when its server names `redirect`; null if it
 * should not: the address is not one of a server (http or https, host and port), it leads from TLS
 * to plain HTTP, or the page is there already. Path and query stay those of the page; the fragment,
 * which may hold an invitation, is left out. Agents follow the same addresses.
 */
export function redirectTarget(page: string, redirect: string): string | null {
  if (!URL.canParse(redirect)) return null;
  const from = new URL(page);
  const to = new URL(redirect);
  if (to.protocol !== 'https:' && (to.protocol !== 'http:' || from.protocol === 'https:'))
    return null;
  const isServer = to.href === `${to.origin}/`; // no user, path, query or fragment
  if (!isServer || to.origin === from.origin) return null;
  return `${to.origin}${from.pathname}${from.search}`;
}

/** Loads the page of another server instead of this one; false: it may not be followed. */
export function reloadAt(server: string): boolean {
  const target = redirectTarget(location.href, server);
  if (target !== null) location.assign(target);
  return target !== null;
}
