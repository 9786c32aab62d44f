// SPDX-License-Identifier: Apache-2.0
// The list of this server's sessions, with a form for new ones.

import { useSignal } from '@preact/signals';
import { render } from 'preact';
import { t } from '../../strings';
import '../style/lobby.css';
import type { SessionSummary } from '../../link/api';
import { nameThatFits } from '../../wire/names';
import { LanguageChoice } from '../language_choice';
import { recall, remember } from '../../strings/memory';
import { shownSessions } from './card_order';
import type { Order } from './card_order';
import type { CardAction } from './card_menu';
import { Cards } from './cards';
import { CloseDialog } from './close_dialog';
import { LobbyState } from './lobby_state';
import { NewBlockForm } from './new_block';
import type { NewBlock } from './new_block_state';
import { RenameDialog } from './rename_dialog';

/** More sessions than one sees at once. */
const MANY = 3;

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

/** A search and an order, where there are many sessions. */
function Finder({ state }: { state: LobbyState }) {
  return (
    <div class="lobby-finder">
      <input
        type="search"
        class="text-input"
        aria-label={t('Search blocks')}
        placeholder={t('Search blocks')}
        value={state.search.value}
        onInput={({ currentTarget }) => (state.search.value = currentTarget.value)}
      />
      <select
        class="select"
        aria-label={t('Order')}
        value={state.order.value}
        onChange={({ currentTarget }) => (state.order.value = currentTarget.value as Order)}
      >
        <option value="active">{t('Last used first')}</option>
        <option value="name">{t('By name')}</option>
      </select>
    </div>
  );
}

/** Makes a block; always in view. */
function NewButtons({ block }: { block: NewBlock }) {
  if (block.whyNot.value !== '') return null;
  return (
    <div class="lobby-new">
      <button
        type="button"
        class="button"
        disabled={block.isBusy.value}
        onClick={() => void block.createAtOnce()}
      >
        {t('Carve a new block')}
      </button>
      <a class="button quiet-button" href="#new-block">
        {t('New block')}
      </a>
    </div>
  );
}

/** What the viewer may do with a session. */
function actionsOf(state: LobbyState, session: SessionSummary): CardAction[] {
  const actions: CardAction[] = [];
  if (session.mayRename)
    actions.push({ label: t('Rename…'), act: () => (state.toRename.value = session) });
  if (state.mayManage.value)
    actions.push({ label: t('Duplicate'), act: () => void state.duplicate(session) });
  if (session.mayClose)
    actions.push({ label: t('Close…'), act: () => (state.toClose.value = session) });
  return actions;
}

export function Lobby({ state }: { state: LobbyState }) {
  const { value: sessions } = state.sessions;
  const { value: fault } = state.fault;
  const { value: block } = state.newBlock;
  const shown = shownSessions(sessions, state.search.value, state.order.value);
  return (
    <main class="lobby">
      <header class="lobby-head">
        <img src="./icon.svg" alt="" width="40" height="40" />
        <h1>Kerf</h1>
        {block && <NewButtons block={block} />}
        <NameField />
        <LanguageChoice />
      </header>
      <p class="lead">
        {sessions.length === 0
          ? t('Nothing here yet. Press “Carve a new block” to start.')
          : t('Choose a block to open.')}
      </p>
      <p class="fault" role="alert" hidden={fault === ''}>
        {fault}
      </p>
      {sessions.length > MANY && <Finder state={state} />}
      <section aria-label={t('Sessions')}>
        {shown.length === 0 && sessions.length > 0 && (
          <p class="quiet" role="status">
            {t('No block has this name.')}
          </p>
        )}
        <Cards sessions={shown} actions={(session) => actionsOf(state, session)} />
      </section>
      {block && <NewBlockForm block={block} />}
      <RenameDialog state={state} />
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
