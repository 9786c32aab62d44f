// SPDX-License-Identifier: Apache-2.0
// Under which name a viewer joins.

import { t } from '../strings';
import { recall, remember } from '../strings/memory';
import { nameThatFits } from '../wire/names';

/** The name in the page's address, or the one used last, or a guest's, which is kept. */
export function viewerName(parameters: URLSearchParams): string {
  const requested = parameters.get('name')?.trim() ?? '';
  const known = requested === '' ? recall('name') : requested;
  if (known) return nameThatFits(known);
  const name = t('Guest {0}', 100 + Math.floor(Math.random() * 900));
  remember('name', name);
  return name;
}
