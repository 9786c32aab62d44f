// SPDX-License-Identifier: Apache-2.0
// What is shown before there is a block.

import { t } from '../strings';
import { h } from '../ui/dom';

export interface StartActions {
  choose: () => void;
  example: () => void;
  carve: () => void;
}

export function startCard({ choose, example, carve }: StartActions): HTMLElement {
  const button = (text: string, action: () => void): HTMLElement => {
    const element = h('button', { type: 'button', class: 'button' }, text);
    element.addEventListener('click', action);
    return element;
  };
  return h(
    'section',
    { class: 'start', 'aria-label': t('Without a server') },
    h('h2', {}, t('Drop an NC program here')),
    h(
      'p',
      {},
      t(
        'G-code, Klartext or APT; with a scene (JSON) or a model as stock (STL, PLY, OBJ) if you like. It is carved in this browser, and no file leaves it.',
      ),
    ),
    h(
      'div',
      { class: 'page-actions' },
      button(t('Choose files…'), choose),
      button(t('Try an example'), example),
      button(t('Carve a block by hand'), carve),
    ),
  );
}
