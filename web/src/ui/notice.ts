// SPDX-License-Identifier: Apache-2.0
// Messages for a person: a short one over the picture while it goes on, or a full page when nothing can be shown.

import { h, setText } from './dom';

export class Notice {
  readonly element = h('div', { class: 'notice', role: 'alert', hidden: '' });

  show(text: string): void {
    this.element.hidden = text === '';
    setText(this.element, text);
  }
}

/** A page that says what went wrong and what can be done. */
export function failurePage(title: string, text: string, actions: { label: string; href: string }[]): HTMLElement {
  return h('main', { class: 'page failure', role: 'alert' },
    h('h1', {}, title), h('p', {}, text),
    h('p', { class: 'page-actions' }, ...actions.map(({ label, href }) => h('a', { class: 'button', href }, label))));
}
