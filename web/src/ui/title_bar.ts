// SPDX-License-Identifier: Apache-2.0
// The bar at the top: the scene's name, the viewer's role, the link, the connection.

import type { SessionModel } from '../model/session';
import { Badge } from './badge';
import { h, iconButton, setText } from './dom';
import { ICONS } from './icons';

export interface TitleBarActions {
  copyLink: () => void;
  invite: () => void;
}

export class TitleBar {
  readonly element: HTMLElement;
  private readonly badge_ = new Badge();
  private readonly name_: HTMLElement;
  private readonly role_ = h('span', { class: 'role', hidden: '' });
  private readonly invite_: HTMLElement;

  constructor(
    private readonly session: string,
    actions: TitleBarActions,
  ) {
    this.name_ = h('h1', { class: 'session-name', title: session }, session);
    this.invite_ = iconButton(ICONS.invite, 'Invite people', '', actions.invite);
    this.invite_.hidden = true;
    const home = h(
      'a',
      { class: 'brand', href: '?list', 'aria-label': 'Kerf: all sessions' },
      h('img', { src: './icon.svg', alt: '', width: '28', height: '28' }),
      h('span', { class: 'brand-name' }, 'Kerf'),
    );
    this.element = h(
      'header',
      { class: 'bar' },
      home,
      this.name_,
      this.role_,
      iconButton(ICONS.link, 'Copy a link to this session', '', actions.copyLink),
      this.invite_,
      this.badge_.element,
    );
  }

  /** Shows the name of the scene, who this viewer is, and what that role may do. */
  update(model: SessionModel, nowMs: number): void {
    const { welcome, participants } = model;
    const name = welcome?.name ?? this.session;
    if (this.name_.textContent !== name) {
      this.name_.textContent = name;
      document.title = `${name} · Kerf`;
    }
    const own = welcome ? participants.get(welcome.participant)?.info.role : undefined;
    const role = own ?? welcome?.role;
    this.role_.hidden = role === undefined;
    setText(this.role_, role ?? '');
    this.invite_.hidden = welcome?.may?.includes('invite') !== true;
    this.badge_.update(model, nowMs);
  }
}
