// SPDX-License-Identifier: Apache-2.0
// The list of this server's sessions, with a form for new ones.

import { useComputed, useSignal } from '@preact/signals';
import { render } from 'preact';
import { t } from '../../strings';
import '../style/lobby.css';
import type { SessionSummary } from '../../link/api';
import { nameThatFits } from '../../wire/names';
import { LanguageChoice } from '../language_choice';
import { recall, remember } from '../../strings/memory';
import { Cards } from './cards';
import { CloseDialog } from './close_dialog';
import { LobbyState } from './lobby_state';
import { NewBlockForm } from './new_block';

function NameField() {
  const text = useSignal(recall('name') ?? '');
  return (
    <label class="lobby-name">
      <span>{t('Your name')}</span>
      <input
        class="text-input"
        maxLength={64}
        autocomplete="nickname"
        placeholder={t('Guest')}
        value={text.value}
        onInput={({ currentTarget }) => {
          text.value = currentTarget.value;
          remember('name', nameThatFits(text.value.trim()));
        }}
      />
    </label>
  );
}

function Lobby({ state }: { state: LobbyState }) {
  const close = useComputed(() =>
    state.mayManage.value
      ? (session: SessionSummary) => void (state.toClose.value = session)
      : null,
  );
  const { value: sessions } = state.sessions;
  const { value: fault } = state.fault;
  const { value: block } = state.newBlock;
  return (
    <main class="lobby">
      <header class="lobby-head">
        <img src="./icon.svg" alt="" width="40" height="40" />
        <h1>Kerf</h1>
        <NameField />
        <LanguageChoice />
      </header>
      <p class="lead">
        {sessions.length === 0
          ? t('Nothing here yet. Create a block to start.')
          : t('Choose a block to open.')}
      </p>
      <p class="fault" role="alert" hidden={fault === ''}>
        {fault}
      </p>
      <section aria-label={t('Sessions')}>
        <Cards sessions={sessions} close={close.value} />
      </section>
      {block && <NewBlockForm block={block} />}
      <CloseDialog state={state} />
    </main>
  );
}

/** Shows the list in place of the page. */
export function showLobby(app: HTMLElement, sessions: readonly SessionSummary[]): void {
  const state = new LobbyState(sessions);
  document.title = 'Kerf';
  render(<Lobby state={state} />, app);
  state.start();
}
