// SPDX-License-Identifier: Apache-2.0

import { useSignal, useSignalEffect } from '@preact/signals';
import { useRef } from 'preact/hooks';
import { t } from '../../strings';
import type { SessionSummary } from '../../link/api';
import { Dialog } from '../dialog';
import type { LobbyState } from './lobby_state';

/** Asks before a session is closed. */
export function CloseDialog({ state }: { state: LobbyState }) {
  const isOpen = useSignal(false);
  const last = useRef<SessionSummary | null>(null); // its name stays while the dialog closes
  const { value: session } = state.toClose;
  last.current = session ?? last.current;
  useSignalEffect(() => {
    isOpen.value = state.toClose.value !== null;
  });
  const name = last.current?.name ?? '';
  return (
    <Dialog
      class="help"
      label={t('Close {0}', name)}
      isOpen={isOpen}
      closed={() => (state.toClose.value = null)}
    >
      <h2>{t('Close {0}?', name)}</h2>
      <p>{t('Everyone leaves the session. The server keeps its history.')}</p>
      <p class="dialog-actions">
        <button
          type="button"
          class="button"
          onClick={() => {
            isOpen.value = false;
            if (session) void state.close(session);
          }}
        >
          {t('Close session')}
        </button>
        <button type="button" class="button quiet-button" onClick={() => (isOpen.value = false)}>
          {t('Keep open')}
        </button>
      </p>
    </Dialog>
  );
}
