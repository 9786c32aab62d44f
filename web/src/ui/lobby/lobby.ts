// SPDX-License-Identifier: Apache-2.0
// The list of this server's sessions, with a form for new ones.

import { t } from '../../strings';
import '../style/lobby.css';
import { listSessions } from '../../link/api';
import type { SessionSummary } from '../../link/api';
import { closeSession, listTemplates, priceOf } from '../../link/lobby_requests';
import type { Template } from '../../link/lobby_requests';
import { ServerError } from '../../link/server_error';
import { nameThatFits } from '../../wire/names';
import { h, setText } from '../dom';
import { sentence } from '../format';
import { languageChoice } from '../language_choice';
import { recall, remember } from '../../strings/memory';
import { Cards } from './cards';
import { NewBlock } from './new_block';

const UPDATE_MS = 3000;

export class Lobby {
  private sessions_: readonly SessionSummary[];
  private readonly cards_ = new Cards();
  private readonly lead_ = h('p', { class: 'lead' });
  private readonly note_ = h('p', { class: 'fault', role: 'alert', hidden: '' });
  private readonly main_: HTMLElement;
  private mayManage_ = false;
  private pollFault_ = ''; // the note's text if it is a fault of polling the list

  constructor(app: HTMLElement, sessions: readonly SessionSummary[]) {
    this.sessions_ = sessions;
    this.main_ = h(
      'main',
      { class: 'lobby' },
      h(
        'header',
        { class: 'lobby-head' },
        h('img', { src: './icon.svg', alt: '', width: '40', height: '40' }),
        h('h1', {}, 'Kerf'),
        this.nameField_(),
        languageChoice(),
      ),
      this.lead_,
      this.note_,
      h('section', { 'aria-label': t('Sessions') }, this.cards_.element),
    );
    app.replaceChildren(this.main_);
    document.title = 'Kerf';
    this.draw_();
    void this.addForm_();
    setInterval(() => void this.update_(), UPDATE_MS);
    document.addEventListener('visibilitychange', () => void this.update_());
  }

  private nameField_(): HTMLElement {
    const input = h('input', { class: 'text-input', maxlength: '64', autocomplete: 'nickname' });
    input.value = recall('name') ?? '';
    input.placeholder = t('Guest');
    input.addEventListener('input', () => remember('name', nameThatFits(input.value.trim())));
    return h('label', { class: 'lobby-name' }, h('span', {}, t('Your name')), input);
  }

  private async addForm_(): Promise<void> {
    let templates: Template[];
    try {
      templates = await listTemplates();
    } catch (problem) {
      this.tell_(sentence((problem as Error).message));
      return;
    }
    const form = new NewBlock(templates, () => this.sessions_.map(({ id }) => id));
    this.main_.append(form.element);
    const reason = await this.obstacle_(templates);
    if (reason !== null) form.forbid(reason);
    this.mayManage_ = reason === null;
    this.draw_();
  }

  /** Why the viewer may not create sessions; null if it may. */
  private async obstacle_(templates: readonly Template[]): Promise<string | null> {
    try {
      await priceOf(templates[0]?.scene ?? {});
    } catch (problem) {
      const { status, message } = problem as ServerError;
      if (status === 401 || status === 403) return sentence(message);
    }
    return null;
  }

  private async update_(): Promise<void> {
    if (document.hidden) return;
    try {
      this.sessions_ = await listSessions();
      if (this.note_.textContent === this.pollFault_) this.tell_(''); // no other fault
      this.draw_();
    } catch (problem) {
      this.pollFault_ = (problem as Error).message;
      this.tell_(this.pollFault_);
    }
  }

  private draw_(): void {
    const empty = this.sessions_.length === 0;
    setText(
      this.lead_,
      empty ? t('Nothing here yet. Create a block to start.') : t('Choose a block to open.'),
    );
    this.cards_.update(this.sessions_, {
      close: this.mayManage_ ? (session) => this.askToClose_(session) : null,
    });
  }

  private askToClose_({ id, name }: SessionSummary): void {
    const close = h('button', { type: 'button', class: 'button' }, t('Close session'));
    const keep = h('button', { type: 'button', class: 'button quiet-button' }, t('Keep open'));
    const dialog = h(
      'dialog',
      { class: 'help', 'aria-label': t('Close {0}', name) },
      h('h2', {}, t('Close {0}?', name)),
      h('p', {}, t('Everyone leaves the session. The server keeps its history.')),
      h('p', { class: 'dialog-actions' }, close, keep),
    );
    keep.addEventListener('click', () => dialog.close());
    close.addEventListener('click', () => {
      dialog.close();
      closeSession(id).then(
        () => void this.update_(),
        (problem: unknown) => this.tell_(sentence((problem as Error).message)),
      );
    });
    dialog.addEventListener('close', () => dialog.remove());
    this.main_.append(dialog);
    dialog.showModal();
  }

  private tell_(text: string): void {
    setText(this.note_, text);
    this.note_.hidden = text === '';
  }
}
