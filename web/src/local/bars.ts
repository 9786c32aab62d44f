// SPDX-License-Identifier: Apache-2.0
// The bar and the toolbar of the page without a server.

import { t } from '../strings';
import { h, iconButton } from '../ui/dom';
import { ICONS } from '../ui/icons';
import type { CameraRig, Preset } from '../view/camera_rig';

export function titleBar(title: HTMLElement): HTMLElement {
  return h(
    'header',
    { class: 'bar' },
    h(
      'span',
      { class: 'brand' },
      h('img', { src: './icon.svg', alt: '', width: '28', height: '28' }),
      h('span', { class: 'brand-name' }, 'Kerf'),
    ),
    h('div', { class: 'titles' }, title),
  );
}

export function viewToolbar(rig: () => CameraRig | undefined): HTMLElement {
  const view = (icon: string, label: string, key: string, preset: Preset): HTMLElement =>
    iconButton(icon, label, key, () => rig()?.preset(preset, performance.now()));
  return h(
    'div',
    { class: 'toolbar', role: 'toolbar', 'aria-label': t('View') },
    iconButton(ICONS.fit, t('Show the whole block'), 'F', () => rig()?.fit(performance.now())),
    view(ICONS.iso, t('Three-quarter view'), '0', 'iso'),
    view(ICONS.front, t('Front'), '1', 'front'),
    view(ICONS.right, t('Right'), '3', 'right'),
    view(ICONS.top, t('Top'), '7', 'top'),
  );
}
