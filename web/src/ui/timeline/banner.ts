// SPDX-License-Identifier: Apache-2.0
// The banner over the picture while it shows the past: which point, who carved there, and the
// button that leads back.

import { t } from '../../strings';
import { h, setText } from '../dom';

export class Banner {
  private readonly place_ = h('span', { class: 'past-place' });
  readonly element: HTMLElement;

  constructor(back: () => void) {
    const button = h('button', { type: 'button', class: 'past-back' }, t('Back to live'));
    button.addEventListener('click', back);
    this.element = h(
      'div',
      { class: 'past-banner', hidden: '' },
      h('span', { role: 'status' }, h('b', {}, t('The past'))),
      this.place_,
      button,
    );
  }

  /** Shows a place; null: the picture shows the present. Returns whether it came or went. */
  show(place: string | null): boolean {
    const was = this.element.hidden;
    this.element.hidden = place === null;
    setText(this.place_, place ?? '');
    return was !== this.element.hidden;
  }
}
