// SPDX-License-Identifier: Apache-2.0
// The choice of the page's language, which begins with that of the browser.

import { language, LANGUAGES, t } from '../strings';
import { remember } from '../strings/memory';
import { h } from './dom';

/** @param reload loads the page again: texts are chosen once */
export function languageChoice(reload = (): void => location.reload()): HTMLElement {
  const select = h(
    'select',
    { class: 'language', 'aria-label': t('Language') },
    ...Object.entries(LANGUAGES).map(([value, name]) => h('option', { value, lang: value }, name)),
  );
  select.value = language;
  select.addEventListener('change', () => {
    remember('language', select.value);
    reload();
  });
  return select;
}
