// SPDX-License-Identifier: Apache-2.0
// The bar at the top: the scene's name and who does what to it, the viewer's role, the link, the
// connection.

import { t } from '../strings';
import { roleName } from '../strings/names';
import { pageAddress } from '../link/request';
import { headlineOf } from '../model/headline';
import { Newcomers } from '../model/newcomers';
import type { Participant } from '../model/participants';
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
  private readonly who_ = h('span', { class: 'headline-who' });
  private readonly far_ = h('span', { class: 'headline-far' });
  private readonly newcomers_ = new Newcomers();
  private readonly headline_ = h('p', { class: 'headline', hidden: '' }, this.who_, this.far_);
  private readonly role_ = h('span', { class: 'role', hidden: '' });
  private readonly invite_: HTMLElement;

  constructor(
    private readonly session: string,
    actions: TitleBarActions,
  ) {
    this.name_ = h('h1', { class: 'session-name', title: session }, session);
    this.invite_ = iconButton(ICONS.invite, t('Invite people'), '', actions.invite);
    this.invite_.hidden = true;
    const home = h(
      'a',
      { class: 'brand', href: '?list', 'aria-label': t('Kerf: all sessions') },
      h('img', { src: './icon.svg', alt: '', width: '28', height: '28' }),
      h('span', { class: 'brand-name' }, 'Kerf'),
    );
    home.addEventListener('click', () => home.setAttribute('href', pageAddress('?list')));
    this.element = h(
      'header',
      { class: 'bar' },
      home,
      h('div', { class: 'titles' }, this.name_, this.headline_),
      this.role_,
      iconButton(ICONS.link, t('Copy a link to this session'), '', actions.copyLink),
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
    const { who: carving, far } = headlineOf(model, this.session, nowMs);
    const isSelf = (one: Participant): boolean =>
      one.info.participant === welcome?.participant ||
      participants.isAgentOf(welcome?.participant, one);
    const newcomer = this.newcomers_.update(participants.all(), isSelf, nowMs);
    const joins = newcomer === '' ? '' : t('{0} has joined', newcomer);
    const who = [carving, joins].filter((text) => text !== '').join(' · ');
    this.headline_.hidden = who === '' || model.state?.at !== undefined;
    setText(this.who_, who);
    setText(this.far_, far);
    this.headline_.title = far === '' ? who : `${who}, ${far}`;
    const own = welcome ? participants.get(welcome.participant)?.info.role : undefined;
    const role = own ?? welcome?.role;
    this.role_.hidden = role === undefined;
    setText(this.role_, role === undefined ? '' : roleName(role));
    this.invite_.hidden = welcome?.may?.includes('invite') !== true;
    this.badge_.update(model, nowMs);
  }
}
