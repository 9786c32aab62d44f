// SPDX-License-Identifier: Apache-2.0
// Those who watch, as chips. The viewer's own chip is a button that makes its name editable.

import { t } from '../strings';
import type { SessionModel } from '../model/session';
import { NAME_BYTES_MAX } from '../wire/names';
import { h } from './dom';

export class Watchers {
  readonly element = h('ul', { class: 'watchers', 'aria-label': t('Watching') });
  private editing_ = false;

  constructor(
    private readonly model: SessionModel,
    private readonly renamed: (name: string) => void,
  ) {}

  /** Shows the list of the model; not while the name is edited. */
  update(): void {
    if (this.editing_) return;
    const { participants, welcome } = this.model;
    const listed = participants.all().filter(({ info }) => info.kind === 'viewer');
    const shown = participants.watchers();
    const others = shown.filter(({ info }) => info.participant !== welcome?.participant);
    const self = shown.find(({ info }) => info.participant === welcome?.participant);
    const chips: HTMLElement[] = others.map(({ info }) => h('li', { class: 'chip' }, info.name));
    if (self) chips.unshift(this.own_(self.info.name));
    const unlisted = participants.viewers - listed.length;
    if (unlisted > 0) chips.push(h('li', { class: 'quiet' }, t('{0} watching', unlisted)));
    this.element.replaceChildren(...chips);
  }

  private own_(name: string): HTMLElement {
    const button = h(
      'button',
      { type: 'button', class: 'chip own', title: t('Change your name') },
      t('{0} (you)', name),
    );
    const item = h('li', {}, button);
    button.addEventListener('click', () => this.edit_(item, name));
    return item;
  }

  private edit_(item: HTMLElement, name: string): void {
    this.editing_ = true;
    const input = h('input', {
      class: 'chip-input',
      'aria-label': t('Your name'),
      maxlength: String(NAME_BYTES_MAX),
      value: name,
    });
    const form = h('form', {}, input);
    item.replaceChildren(form);
    input.select();
    input.focus();
    const end = (chosen: string): void => {
      if (!this.editing_) return;
      this.editing_ = false;
      if (chosen !== '' && chosen !== name) this.renamed(chosen);
      this.update();
    };
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      end(input.value.trim());
    });
    input.addEventListener('blur', () => end(input.value.trim()));
    input.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') end(name);
    });
  }
}
