// SPDX-License-Identifier: Apache-2.0
// The sessions as cards: picture, name, people, age, size, the one that was active last first.
// They follow what happens on the server.

import { t } from '../../strings';
import type { SessionSummary } from '../../link/api';
import { sessionDetails } from '../../link/lobby_requests';
import type { Person, SessionDetails } from '../../link/lobby_requests';
import { pictureUrl, PictureVersions } from '../../link/picture_url';
import { ageText, stockText } from '../../model/new_block';
import { h, setText } from '../dom';
import { figure } from '../format';
import { sessionUrl } from './session_url';

const PEOPLE_MAX = 4;

function chip({ name, color }: Person): HTMLElement {
  const dot = h('span', { class: 'chip-dot', 'aria-hidden': 'true' });
  dot.style.background = color;
  return h('li', { class: 'chip' }, dot, name);
}

/** Who carves first, then who watches. */
function ordered(people: readonly Person[]): Person[] {
  const watches = ({ kind }: Person): boolean => kind === 'viewer';
  return [...people.filter((one) => !watches(one)), ...people.filter(watches)];
}

export interface CardActions {
  /** Null: the viewer may not close sessions. */
  close: ((session: SessionSummary) => void) | null;
}

class Card {
  private readonly picture_ = h('img', {
    class: 'card-picture',
    alt: '',
    width: '480',
    height: '360',
  });
  private readonly name_ = h('strong');
  private readonly people_ = h('ul', {
    class: 'chips',
    'aria-label': t('Participants'),
    hidden: '',
  });
  private readonly facts_ = h('span', { class: 'quiet' });
  private readonly size_ = h('span', { class: 'quiet' });
  private readonly close_: HTMLButtonElement;
  readonly element: HTMLElement;
  private summary_: SessionSummary;
  private readonly versions_ = new PictureVersions();
  private askedFor_ = -1; // number of participants

  constructor(
    summary: SessionSummary,
    private actions_: CardActions,
  ) {
    this.summary_ = summary;
    this.close_ = h(
      'button',
      { type: 'button', class: 'card-close', 'aria-label': t('Close {0}', summary.name) },
      t('Close…'),
    );
    this.close_.addEventListener('click', () => this.actions_.close?.(this.summary_));
    const link = h(
      'a',
      { class: 'card', href: sessionUrl(summary.id) },
      this.picture_,
      h('span', { class: 'card-text' }, this.name_, this.facts_, this.size_),
    );
    this.element = h('li', { class: 'card-place' }, link, this.people_, this.close_);
  }

  update(summary: SessionSummary, actions: CardActions): void {
    this.summary_ = summary;
    this.actions_ = actions;
    this.close_.hidden = actions.close === null;
    setText(this.name_, summary.name);
    const version = this.versions_.next(summary.motions, summary.removedVolumeMm3);
    if (version !== null) this.picture_.src = pictureUrl(summary.id, version, 480);
    const { activeMs } = summary;
    setText(this.facts_, activeMs === null ? '' : t('Active {0}', ageText(activeMs, Date.now())));
    void this.ask_();
  }

  /** Asks for people and stock if they may have changed. */
  private async ask_(): Promise<void> {
    const { id, participants } = this.summary_;
    if (participants === this.askedFor_) return;
    this.askedFor_ = participants;
    try {
      this.show_(await sessionDetails(id));
    } catch {
      this.askedFor_ = -1; // with the next list
    }
  }

  private show_({ people, stock, pitchMm }: SessionDetails): void {
    const shown = ordered(people).slice(0, PEOPLE_MAX);
    const left = people.length - shown.length;
    const rest = left > 0 ? [h('li', { class: 'chip' }, `+ ${left}`)] : [];
    this.people_.replaceChildren(...shown.map(chip), ...rest);
    this.people_.hidden = people.length === 0;
    setText(this.size_, t('{0} · detail {1} mm', stockText(stock), figure(pitchMm)));
  }
}

export class Cards {
  readonly element = h('ul', { class: 'cards' });
  private readonly cards_ = new Map<string, Card>();

  update(sessions: readonly SessionSummary[], actions: CardActions): void {
    for (const id of this.cards_.keys()) {
      if (!sessions.some((session) => session.id === id)) this.remove_(id);
    }
    const newest = [...sessions].sort((a, b) => (b.activeMs ?? 0) - (a.activeMs ?? 0));
    newest.forEach((session, place) => {
      const card = this.cards_.get(session.id) ?? this.make_(session, actions);
      card.update(session, actions);
      this.put_(card.element, place);
    });
  }

  private make_(session: SessionSummary, actions: CardActions): Card {
    const card = new Card(session, actions);
    this.cards_.set(session.id, card);
    return card;
  }

  /** A card that moves keeps the focus. */
  private put_(card: HTMLElement, place: number): void {
    const there = this.element.children[place] ?? null;
    if (there === card) return;
    const focused = document.activeElement;
    this.element.insertBefore(card, there);
    if (focused instanceof HTMLElement && card.contains(focused))
      focused.focus({ preventScroll: true });
  }

  private remove_(id: string): void {
    this.cards_.get(id)?.element.remove();
    this.cards_.delete(id);
  }
}
