// SPDX-License-Identifier: Apache-2.0
// The choice of what dragging with the mouse buttons does.

import { useSignal, useSignalEffect } from '@preact/signals';
import { t } from '../strings';
import { recall, remember } from '../strings/memory';
import { navigationOf, NAVIGATIONS } from '../model/navigation';
import type { Picture } from './picture';

const KEY = 'navigation';

export function NavigationChoice({ picture }: { picture: Picture }) {
  const chosen = useSignal(navigationOf(recall(KEY)));
  useSignalEffect(() => picture.setNavigation(chosen.value));
  return (
    <label class="navigation">
      {t('Mouse')}
      <select
        class="language"
        aria-label={t('Mouse buttons as in')}
        title={t('What the middle and right buttons do when dragging')}
        value={chosen.value.id}
        onChange={({ currentTarget }) => {
          remember(KEY, currentTarget.value);
          chosen.value = navigationOf(currentTarget.value);
        }}
      >
        {NAVIGATIONS.map(({ id, name }) => (
          <option key={id} value={id}>
            {name}
          </option>
        ))}
      </select>
    </label>
  );
}
