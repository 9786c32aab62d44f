// SPDX-License-Identifier: Apache-2.0

import { useSignal } from '@preact/signals';
import { t } from '../strings';
import { recall, remember } from '../strings/memory';
import { nameThatFits } from '../wire/names';

/** The name under which the hand's strokes are in the file; the pages of sessions have the same. */
export function NameField({ hidden }: { hidden: boolean }) {
  const text = useSignal(recall('name') ?? '');
  return (
    <label class="own-name-row quiet" hidden={hidden}>
      <span>{t('Your name')}</span>
      <input
        type="text"
        autocomplete="nickname"
        class="own-name"
        placeholder={t('You')}
        value={text.value}
        onInput={({ currentTarget }) => (text.value = currentTarget.value)}
        onChange={() => {
          text.value = nameThatFits(text.value.trim());
          remember('name', text.value);
        }}
      />
    </label>
  );
}
