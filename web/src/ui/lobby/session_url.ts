// SPDX-License-Identifier: Apache-2.0
// Addresses of pages.

/** The page's first act: it plays the cuts of a program, or has a hand carve. */
export type FirstAct = 'play' | 'carve';

export function sessionUrl(id: string, first?: FirstAct): string {
  return `?session=${encodeURIComponent(id)}${first ? `&${first}` : ''}`;
}
