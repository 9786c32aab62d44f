// SPDX-License-Identifier: Apache-2.0
// Why one may not carve, as sentences for the user; empty: one may.

import { t } from '../strings';
import { roleName } from '../strings/names';
import { pauseText } from '../ui/format';
import type { SessionModel } from '../model/session';
import type { Welcome } from '../wire/types';

/** Why this viewer may not. */
export function whyNotCarve({ may, role }: Pick<Welcome, 'may' | 'role'>): string {
  if (may === undefined || may.includes('carve')) return '';
  return role === undefined
    ? t('Your role does not allow carving.')
    : t('Your role, {0}, does not allow carving.', roleName(role));
}

/**
 * Why no stroke may begin now. Without the watcher's connection the cut would not be seen.
 * `isJoined`: as an agent.
 */
export function whyNotNow(
  { state, status }: Pick<SessionModel, 'state' | 'status'>,
  isJoined: boolean,
): string {
  if (status !== 'connected' || !isJoined) return t('Not connected yet. Wait a moment.');
  if (state?.at) return t('You are viewing the past. Go back to live to carve.');
  return pauseText(state);
}

/** Why the server rejects an undo or redo, in the user's language; another reason stays as it is. */
export function rejectionText(reason: string): string {
  const [, change] = /^participant \d+ has no stroke to (undo|redo)$/.exec(reason) ?? [];
  if (change === undefined) return reason;
  return change === 'undo' ? t('There is no stroke to undo.') : t('There is no stroke to redo.');
}
