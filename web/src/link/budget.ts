// SPDX-License-Identifier: Apache-2.0
// How much of the line the picture may take.

/** The server's bounds (server/wire/README.md), and the budget where data is saved; bytes/s. */
const LEAST = 25_000;
const MOST = 1_000_000_000;
const SAVED = 200_000;

/**
 * Bytes per second of the surface: `?budget=` of the page's address, in kB/s, within the server's
 * bounds; without it 200 kB/s where the browser is set to save data. 0: any.
 */
export function viewBudget(
  parameters: URLSearchParams = new URLSearchParams(location.search),
  line: unknown = (navigator as { connection?: unknown }).connection,
): number {
  const stated = parameters.get('budget') ?? '';
  const bytes = stated.trim() === '' ? Number.NaN : Math.round(1000 * Number(stated));
  if (bytes === 0) return 0;
  if (bytes > 0) return Math.min(Math.max(bytes, LEAST), MOST);
  return (line as { saveData?: boolean } | undefined)?.saveData === true ? SAVED : 0;
}
