// SPDX-License-Identifier: Apache-2.0
// The connection badge: state, round trip, frames per second and age of the picture.

import { t } from '../strings';
import type { SessionModel } from '../model/session';
import { h, setText } from './dom';
import { milliseconds } from './format';

const STALE_MS = 1000;

export type BadgeState = SessionModel['status'] | 'stale' | 'silent' | 'past';

/** What the badge says of a session now. `brief` is all that fits on a phone. */
export function badgeOf(
  model: SessionModel,
  nowMs: number,
): { state: BadgeState; label: string; brief: string; more: string } {
  if (model.status !== 'connected')
    return { state: model.status, label: LABELS[model.status], brief: '', more: '' };
  const { overdueMs } = model.liveness;
  if (overdueMs > 0) {
    const brief = t('for {0} s', Math.floor(overdueMs / 1000));
    return { state: 'silent', label: LABELS.silent, brief, more: '' };
  }
  const active = model.active(nowMs);
  const staleness = model.stalenessMs(nowMs);
  const isStale = (active && staleness > STALE_MS) || model.lag.isBehind(nowMs);
  const state = model.state?.at ? 'past' : isStale ? 'stale' : 'connected';
  const age = active ? t('{0} old', milliseconds(staleness)) : t('still');
  return {
    state,
    label: LABELS[state],
    brief: `RTT ${milliseconds(model.clock.rttMs)}`,
    more: t(' · {0} frames/s · {1}', model.frames.perSecond(nowMs), age) + budgetOf(model),
  };
}

function budgetOf({ welcome }: SessionModel): string {
  if (welcome?.budget === undefined) return '';
  return t(' · at most {0} kB/s', Math.round(welcome.budget / 1000));
}

export class Badge {
  private readonly state_ = h('span', { class: 'badge-state' });
  private readonly brief_ = h('span');
  private readonly more_ = h('span', { class: 'badge-more' });
  // Hidden from screen readers, which announce changes of the state only.
  private readonly detail_ = h(
    'span',
    { class: 'badge-detail', 'aria-hidden': 'true' },
    this.brief_,
    this.more_,
  );
  readonly element = h(
    'div',
    {
      class: 'badge',
      role: 'status',
      'aria-live': 'polite',
      title: t('Round trip to the server, frames received per second, age of the picture'),
    },
    h('span', { class: 'badge-dot' }),
    this.state_,
    this.detail_,
  );

  update(model: SessionModel, nowMs: number): void {
    const { state, label, brief, more } = badgeOf(model, nowMs);
    this.element.dataset['state'] = state;
    setText(this.state_, label);
    this.detail_.hidden = brief === '';
    setText(this.brief_, brief);
    setText(this.more_, more);
  }
}

const LABELS = {
  connecting: t('Connecting'),
  connected: t('Live'),
  past: t('Past'),
  stale: t('Behind'),
  silent: t('No answer'),
  reconnecting: t('Reconnecting'),
  stopped: t('Disconnected'),
} as const;
