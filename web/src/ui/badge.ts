// SPDX-License-Identifier: Apache-2.0
// The connection badge: state, round trip, frames per second and age of the picture.

import type { SessionModel } from '../model/session';
import { h, setText } from './dom';
import { milliseconds } from './format';

const STALE_MS = 1000;

export class Badge {
  private readonly state_ = h('span', { class: 'badge-state' });
  private readonly rtt_ = h('span');
  private readonly more_ = h('span', { class: 'badge-more' });
  // Hidden from screen readers, which announce changes of the state only.
  private readonly detail_ = h(
    'span',
    { class: 'badge-detail', 'aria-hidden': 'true' },
    this.rtt_,
    this.more_,
  );
  readonly element = h(
    'div',
    { class: 'badge', role: 'status', 'aria-live': 'polite' },
    h('span', { class: 'badge-dot' }),
    this.state_,
    this.detail_,
  );

  update(model: SessionModel, nowMs: number): void {
    const staleness = model.stalenessMs(nowMs);
    const stale = model.status === 'connected' && model.active(nowMs) && staleness > STALE_MS;
    this.element.dataset['state'] = stale ? 'stale' : model.status;
    setText(this.state_, stale ? 'Behind' : LABELS[model.status]);
    this.detail_.hidden = model.status !== 'connected';
    if (this.detail_.hidden) return;
    const frames = model.frames.perSecond(nowMs);
    const age = model.active(nowMs) ? `${milliseconds(staleness)} old` : 'still';
    setText(this.rtt_, `RTT ${milliseconds(model.clock.rttMs)}`);
    setText(this.more_, ` · ${frames} frames/s · ${age}`);
    this.element.title = 'Round trip to the server, frames received per second, age of the picture';
  }
}

const LABELS = {
  connecting: 'Connecting',
  connected: 'Live',
  reconnecting: 'Reconnecting',
  stopped: 'Disconnected',
} as const;
