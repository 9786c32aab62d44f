// SPDX-License-Identifier: Apache-2.0
// The choice of what dragging with the mouse buttons does.

import { t } from '../strings';
import { recall, remember } from '../strings/memory';
import { navigationOf, NAVIGATIONS } from '../model/navigation';
import type { Navigation } from '../model/navigation';
import { h } from './dom';

const KEY = 'navigation';

/** @param chosen is called at once with the choice of an earlier visit */
export function navigationChoice(chosen: (navigation: Navigation) => void): HTMLElement {
  const select = h(
    'select',
    { class: 'language', 'aria-label': t('Mouse buttons as in') },
    ...NAVIGATIONS.map(({ id, name }) => h('option', { value: id }, name)),
  );
  select.title = t('What the middle and right buttons do when dragging');
  select.value = navigationOf(recall(KEY)).id;
  select.addEventListener('change', () => {
    remember(KEY, select.value);
    chosen(navigationOf(select.value));
  });
  chosen(navigationOf(select.value));
  return h('label', { class: 'navigation' }, t('Mouse'), select);
}
