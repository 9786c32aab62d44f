// SPDX-License-Identifier: Apache-2.0

import { useSignal, useSignalEffect } from '@preact/signals';
import { useRef } from 'preact/hooks';
import { t } from '../../strings';
import type { SessionSummary } from '../../link/api';
import { Dialog } from '../dialog';
import type { LobbyState } from './lobby_state';

/** Asks for another name of a session. */
export function RenameDialog({ state }: { state: LobbyState }) {
  const isOpen = useSignal(false);
  const text = useSignal('');
  const fault = useSignal('');
  const last = useRef<SessionSummary | null>(null); // its name stays while the dialog closes
  const { value: session } = state.toRename;
  last.current = session ?? last.current;
  useSignalEffect(() => {
    const { value: chosen } = state.toRename;
    isOpen.value = chosen !== null;
    fault.value = '';
    if (chosen) text.value = chosen.name;
  });
  const name = last.current?.name ?? '';
  const save = async (): Promise<void> => {
    if (!session) return;
    fault.value = await state.rename(session, text.value.trim());
    if (fault.value === '') isOpen.value = false;
  };
  return (
    <Dialog
      class="help"
      label={t('Rename {0}', name)}
      isOpen={isOpen}
      closed={() => (state.toRename.value = null)}
    >
      <h2>{t('Rename {0}', name)}</h2>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          void save();
        }}
      >
        <label class="field">
          <span class="field-name">{t('Name')}</span>
          <input
            class="text-input"
            maxLength={200}
            required
            value={text.value}
            onInput={({ currentTarget }) => (text.value = currentTarget.value)}
          />
        </label>
        <p class="fault" role="alert" hidden={fault.value === ''}>
          {fault.value}
        </p>
        <p class="dialog-actions">
          <button type="submit" class="button" disabled={text.value.trim() === ''}>
            {t('Save name')}
          </button>
          <button type="button" class="button quiet-button" onClick={() => (isOpen.value = false)}>
            {t('Cancel')}
          </button>
        </p>
      </form>
    </Dialog>
  );
}
