// SPDX-License-Identifier: Apache-2.0
// The section of the panel for pins, shown views and pictures. Its code is a chunk of its own, loaded
// when there is something to show or a button is pressed.

import { t } from '../../strings';
import { h } from '../dom';
import type { TogetherHost, TogetherParts } from './host';
import type { TogetherPanel } from './together_panel';

export interface Together {
  element: HTMLElement;
  /** Called about ten times a second. */
  update: () => void;
}

type Action = 'setPin' | 'share' | 'savePicture' | 'saveVideo';

export function mountTogether(host: TogetherHost): Together {
  let panel: TogetherPanel | null = null;
  let loading: Promise<void> | null = null;
  const load = async (): Promise<void> => {
    const { TogetherPanel: Panel } = await import('./together_panel');
    if (host.picture.viewer) panel = new Panel(host, host.picture.viewer, parts);
    loading = null;
  };
  const start = (): Promise<void> =>
    (loading ??= load().catch((problem: unknown) => {
      loading = null;
      console.warn('The section “Together” did not load:', problem);
    }));
  const button = (label: string, title: string, action: Action): HTMLButtonElement => {
    const made = h('button', { type: 'button', class: 'history-button', title }, label);
    made.addEventListener('click', () => {
      if (made.getAttribute('aria-disabled') === 'true' || !host.picture.viewer) return;
      if (panel) panel[action]();
      else void start().then(() => panel?.[action]());
    });
    return made;
  };
  const parts: TogetherParts = {
    pin: button(t('Add a pin'), t('Attach a note to a spot on the block, for everyone'), 'setPin'),
    share: button(t('Share my view'), t('Let others follow your view'), 'share'),
    video: button(t('Save video'), t('MP4: the block turns once'), 'saveVideo'),
    cameras: h('ul', { class: 'shown-cameras', 'aria-label': t('Shared views') }),
    pins: h('ul', { class: 'pins', 'aria-label': t('Pins') }),
  };
  parts.share.setAttribute('aria-pressed', 'false');
  const picture = button(t('Save picture'), t('PNG, 3840 pixels wide'), 'savePicture');
  const element = h(
    'section',
    { 'aria-label': t('Share') },
    h('h2', {}, t('Share')),
    h(
      'div',
      { class: 'history-actions together-actions' },
      parts.pin,
      parts.share,
      picture,
      parts.video,
    ),
    parts.cameras,
    parts.pins,
  );
  const update = (): void => {
    const { welcome, together } = host.model;
    const maySet = welcome?.may === undefined || welcome.may.includes('place_pins');
    parts.pin.hidden = !maySet;
    for (const made of [parts.pin, parts.share, picture, parts.video]) {
      const isDisabled = String(!host.picture.viewer);
      if (made.getAttribute('aria-disabled') !== isDisabled)
        made.setAttribute('aria-disabled', isDisabled);
    }
    if (panel) panel.update();
    else if (host.picture.viewer && together.pins.length + together.cameras.length > 0)
      void start();
  };
  return { element, update };
}
