// SPDX-License-Identifier: Apache-2.0
// Which stroke the undo and redo buttons mean.

import { t } from '../strings';
import { roleName } from '../strings/names';
import type { Stroke, StrokeChange } from './stroke';
import type { Welcome } from '../wire/types';

/**
 * Returns the stroke that undo or redo changes next: of the given participant, or of anyone if it is
 * null. Undo takes the newest stroke that stands. Redo takes the oldest undone stroke after the
 * newest one that stands, so that undo and redo alternate; null if there is none.
 */
export function nextStroke(
  strokes: readonly Stroke[],
  change: StrokeChange,
  participant: number | null,
): Stroke | null {
  const own = strokes.filter(
    (stroke) => participant === null || stroke.participant === participant,
  );
  const standing = own.map(({ undone }) => undone).lastIndexOf(false);
  return (change === 'undo' ? own[standing] : own[standing + 1]) ?? null;
}

/** Returns why this viewer may not undo, as a sentence for the user; empty: it may. */
export function whyNotUndo({ may, role }: Pick<Welcome, 'may' | 'role'>): string {
  if (may === undefined || may.includes('undo')) return '';
  return role === undefined
    ? t('Your role does not allow undoing.')
    : t('Your role, {0}, does not allow undoing.', roleName(role));
}
