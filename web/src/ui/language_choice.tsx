// SPDX-License-Identifier: Apache-2.0

import { language, LANGUAGES, t } from '../strings';
import { remember } from '../strings/memory';

interface LanguageChoiceProps {
  /** Loads the page again, because the texts are chosen once. */
  reload?: () => void;
}

/** The choice of the page's language, which begins with that of the browser. */
export function LanguageChoice({ reload = () => location.reload() }: LanguageChoiceProps) {
  return (
    <select
      class="language"
      aria-label={t('Language')}
      value={language}
      onChange={({ currentTarget }) => {
        remember('language', currentTarget.value);
        reload();
      }}
    >
      {Object.entries(LANGUAGES).map(([value, name]) => (
        <option key={value} value={value} lang={value}>
          {name}
        </option>
      ))}
    </select>
  );
}
