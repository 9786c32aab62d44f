// SPDX-License-Identifier: Apache-2.0
// The buttons over the picture: views, following, arrows, sound, help.

import { t } from '../strings';
import { iconButton } from './dom';
import { h } from './dom';
import { ICONS } from './icons';

export interface ToolbarActions {
  fit: () => void;
  iso: () => void;
  front: () => void;
  right: () => void;
  top: () => void;
  followNext: () => void;
  toggleArrows: () => void;
  help: () => void;
}

/** The states of the buttons: pressed, or of no use now. */
export interface ToolbarState {
  hasPicture: boolean;
  canFollow: boolean;
  follows: boolean;
  arrowsVisible: boolean;
}

function setState(button: HTMLElement, name: 'aria-pressed' | 'aria-disabled', is: boolean): void {
  const value = String(is);
  if (button.getAttribute(name) !== value) button.setAttribute(name, value);
}

export class Toolbar {
  readonly element: HTMLElement;
  private readonly views_: HTMLElement[];
  private readonly follow_: HTMLElement;
  private readonly arrows_: HTMLElement;

  constructor(actions: ToolbarActions, sound: HTMLElement) {
    this.views_ = [
      iconButton(ICONS.fit, t('Show the whole block'), 'F', actions.fit),
      iconButton(ICONS.iso, t('Three-quarter view'), '0', actions.iso),
      iconButton(ICONS.front, t('Front'), '1', actions.front),
      iconButton(ICONS.right, t('Right'), '3', actions.right),
      iconButton(ICONS.top, t('Top'), '7', actions.top),
    ];
    this.follow_ = iconButton(ICONS.follow, t('Follow the next tool'), 'N', actions.followNext);
    this.arrows_ = iconButton(
      ICONS.arrows,
      t('Force and torque arrows'),
      'A',
      actions.toggleArrows,
    );
    const help = iconButton(ICONS.help, t('Keyboard and mouse'), '?', actions.help);
    help.classList.add('help-button');
    this.element = h(
      'div',
      { class: 'toolbar', role: 'toolbar', 'aria-label': t('View') },
      ...this.views_,
      this.follow_,
      this.arrows_,
      sound,
      help,
    );
  }

  update({ hasPicture, canFollow, follows, arrowsVisible }: ToolbarState): void {
    for (const button of [...this.views_, this.arrows_])
      setState(button, 'aria-disabled', !hasPicture);
    setState(this.follow_, 'aria-disabled', !hasPicture || !canFollow);
    setState(this.follow_, 'aria-pressed', follows);
    setState(this.arrows_, 'aria-pressed', arrowsVisible);
  }
}
