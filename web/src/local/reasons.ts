// SPDX-License-Identifier: Apache-2.0
// Why the module rejects a hand's action, in the user's language
// (web/wasm/files/journal_block.cpp).

import { t } from '../strings';

const TEXTS = new Map([
  ['there is no stroke to undo', t('There is no stroke to undo.')],
  ['there is no stroke to redo', t('There is no stroke to redo.')],
]);

/** A reason that is not known stays as it is. */
export function translated(reason: string): string {
  return TEXTS.get(reason) ?? reason;
}
