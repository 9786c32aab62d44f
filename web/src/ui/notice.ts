// SPDX-License-Identifier: Apache-2.0
// Messages to the user: a notice over the picture, or a full page if there is no picture.

import { h, setText } from './dom';

export class Notice {
  readonly element = h('div', { class: 'notice', role: 'alert', hidden: '' });

  show(text: string): void {
    this.element.hidden = text === '';
    setText(this.element, text);
  }
}

/** Creates a page that explains a failure and links to possible actions. */
export function failurePage(
  title: string,
  text: string,
  actions: { label: string; href: string }[],
): HTMLElement {
  return h(
    'main',
    { class: 'page failure', role: 'alert' },
    h('h1', {}, title),
    h('p', {}, text),
    h(
      'p',
      { class: 'page-actions' },
      ...actions.map(({ label, href }) => h('a', { class: 'button', href }, label)),
    ),
  );
}
