// SPDX-License-Identifier: Apache-2.0
// Named versions: go to one, name the block that is shown, rename or delete one; and a branch, a session that
// begins as the block is shown.

import { t } from '../../strings';
import type { Version } from '../../link/history';
import { h, setText } from '../dom';
import { count } from '../format';

export interface BookmarkActions {
  go: (record: number) => void;
  name: (name: string) => void;
  rename: (old: string, name: string) => void;
  remove: (name: string) => void;
  branch: (id: string) => void;
}

type Form = 'version' | 'rename' | 'branch';

export class Bookmarks {
  private readonly list_ = h('select', { class: 'timeline-versions', 'aria-label': t('Versions') });
  private readonly rename_ = this.button_(t('Rename'));
  private readonly delete_ = this.button_(t('Delete'));
  private readonly name_ = this.button_(t('Save a version'));
  private readonly branch_ = this.button_(t('Branch from here'));
  private readonly input_ = h('input', { class: 'timeline-input', maxlength: '64', required: '' });
  private readonly save_ = h('button', { class: 'timeline-action' }, t('Save'));
  private readonly form_ = h(
    'form',
    { class: 'timeline-form', hidden: '' },
    this.input_,
    this.save_,
  );
  readonly element = h(
    'div',
    { class: 'timeline-bookmarks', role: 'group', 'aria-label': t('Versions and branches') },
    this.list_,
    this.rename_,
    this.delete_,
    this.name_,
    this.branch_,
    this.form_,
  );
  private readonly openers_: Record<Form, HTMLElement> = {
    version: this.name_,
    rename: this.rename_,
    branch: this.branch_,
  };
  private shown_ = '';
  private versions_: readonly Version[] = [];
  private asks_: Form | null = null;

  /** @param proposed a name for a branch from the point that is shown */
  constructor(
    actions: BookmarkActions,
    private readonly proposed: () => string,
  ) {
    this.list_.addEventListener('change', () => {
      if (this.version_) actions.go(this.version_.record);
      this.update_();
    });
    this.delete_.addEventListener('click', () => {
      if (this.list_.value !== '') actions.remove(this.list_.value);
    });
    this.rename_.addEventListener('click', () => this.ask_('rename'));
    this.name_.addEventListener('click', () => this.ask_('version'));
    this.branch_.addEventListener('click', () => this.ask_('branch'));
    const cancel = this.button_(t('Cancel'));
    cancel.addEventListener('click', () => this.ask_(null));
    this.form_.append(cancel);
    this.form_.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.ask_(null);
    });
    this.form_.addEventListener('submit', (event) => {
      event.preventDefault();
      const text = this.input_.value.trim();
      const what = this.asks_;
      this.ask_(null);
      if (text === '') return;
      if (what === 'branch') actions.branch(text);
      else if (what === 'version') actions.name(text);
      else if (this.version_) actions.rename(this.version_.name, text);
    });
  }

  show(versions: readonly Version[]): void {
    const key = JSON.stringify(versions);
    if (key === this.shown_) return;
    this.shown_ = key;
    this.versions_ = versions;
    const { value } = this.list_;
    this.list_.replaceChildren(
      h('option', { value: '' }, versions.length === 0 ? t('No versions') : t('Go to version…')),
      ...versions.map(({ name, record, author }) =>
        h('option', { value: name }, `${name} · ${count(record)}${author ? ` · ${author}` : ''}`),
      ),
    );
    this.list_.value = versions.some(({ name }) => name === value) ? value : '';
    this.update_();
  }

  /** What this viewer may do. */
  allow(versions: boolean, branches: boolean): void {
    this.name_.hidden = !versions;
    this.rename_.hidden = !versions;
    this.delete_.hidden = !versions;
    this.branch_.hidden = !branches;
  }

  /** Versions of others may be visited, and changed by those whom the server lets. */
  private update_(): void {
    const isFixed = this.version_?.may_change !== true;
    for (const button of [this.rename_, this.delete_]) button.disabled = isFixed;
  }

  /** The one that is chosen. */
  private get version_(): Version | undefined {
    return this.versions_.find(({ name }) => name === this.list_.value);
  }

  private ask_(what: Form | null): void {
    const last = this.asks_;
    this.asks_ = what;
    this.form_.hidden = what === null;
    if (what === null) {
      if (last) this.openers_[last].focus();
      return;
    }
    const isBranch = what === 'branch';
    const label = isBranch ? t('ID of the new session') : t('Name of the version');
    const isRename = what === 'rename';
    this.input_.setAttribute('aria-label', label);
    this.input_.placeholder = label;
    this.input_.pattern = isBranch ? '[a-z0-9_\\-]{1,64}' : '[^\\/]+';
    this.input_.title = isBranch ? t('Lowercase letters, digits, - and _') : '';
    this.input_.value = isBranch ? this.proposed() : isRename ? this.list_.value : '';
    setText(this.save_, isBranch ? t('Create branch') : isRename ? t('Save name') : t('Save'));
    this.input_.focus();
    this.input_.select();
  }

  private button_(label: string): HTMLButtonElement {
    return h('button', { type: 'button', class: 'timeline-action' }, label);
  }
}
