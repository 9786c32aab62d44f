// SPDX-License-Identifier: Apache-2.0
// Why one may not carve, as sentences for the user; empty: one may.

import { t } from '../strings';
import { roleName } from '../strings/names';
import type { SessionModel } from '../model/session';
import type { Welcome } from '../wire/types';

const DISK_FULL = t('The server cannot write: nothing is carved until it can.');
const NO_LEASE = t('The servers cannot reach each other: nothing is carved until they can.');

/** Why this viewer may not. */
export function whyNotCarve({ may, role }: Pick<Welcome, 'may' | 'role'>): string {
  if (may === undefined || may.includes('carve')) return '';
  return role === undefined
    ? t('Your role may not carve.')
    : t('Your role, {0}, may not carve.', roleName(role));
}

/**
 * Why no stroke may begin now. Without the watcher's connection nobody would see what is cut.
 * `isJoined`: as an agent.
 */
export function whyNotNow(
  { state, status }: Pick<SessionModel, 'state' | 'status'>,
  isJoined: boolean,
): string {
  if (status !== 'connected' || !isJoined) return t('Not connected yet: wait a moment.');
  if (state?.at) return t('This is the past: go back to live to carve.');
  if (state?.paused === 'lease') return NO_LEASE;
  return state?.paused ? DISK_FULL : '';
}
