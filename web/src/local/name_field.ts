// SPDX-License-Identifier: Apache-2.0
// The name under which the hand's strokes are in the file; the pages of sessions have the same.

import { t } from '../strings';
import { recall, remember } from '../strings/memory';
import { h } from '../ui/dom';
import { nameThatFits } from '../wire/names';

export function nameField(): HTMLElement {
  const input = h('input', { type: 'text', autocomplete: 'nickname', class: 'own-name' });
  input.value = recall('name') ?? '';
  input.placeholder = t('You');
  input.addEventListener('change', () => {
    const name = nameThatFits(input.value.trim());
    input.value = name;
    remember('name', name);
  });
  return h('label', { class: 'own-name-row quiet' }, h('span', {}, t('Your name')), input);
}
