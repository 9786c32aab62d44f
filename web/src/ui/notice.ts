// SPDX-License-Identifier: Apache-2.0
// Messages to the user: a notice over the picture, or a full page if there is no picture.

import { h, setText } from './dom';

/** The text of a notice; `wait` counts down and is not read aloud. */
export interface NoticeText {
  text: string;
  wait?: string;
  action?: string;
}

export class Notice {
  private readonly text_ = h('span');
  private readonly wait_ = h('span', { class: 'notice-wait', 'aria-hidden': 'true' });
  private readonly action_ = h('button', { type: 'button', class: 'notice-action', hidden: '' });
  readonly element = h(
    'div',
    { class: 'notice', role: 'alert', hidden: '' },
    this.text_,
    this.wait_,
    this.action_,
  );

  /** `act` is called when the action is pressed. */
  constructor(act: () => void) {
    this.action_.addEventListener('click', act);
  }

  show({ text, wait = '', action = '' }: NoticeText): void {
    this.element.hidden = text === '';
    setText(this.text_, text);
    setText(this.wait_, wait);
    this.action_.hidden = action === '';
    setText(this.action_, action);
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
