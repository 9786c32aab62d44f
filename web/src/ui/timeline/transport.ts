// SPDX-License-Identifier: Apache-2.0
// The buttons of the timeline: steps, play and pause, speed, back to live.

import { t } from '../../strings';
import { h, setText } from '../dom';

const STEPS = [-1000, -100, -1] as const;
const RATES = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];

export interface TransportActions {
  step: (motions: number) => void;
  /** Plays with a rate, or rests with 0. */
  play: (rate: number) => void;
  /** Missing where there is no present. */
  live?: () => void;
}

function signed(motions: number): string {
  return motions < 0 ? `−${-motions}` : `+${motions}`;
}

export class Transport {
  private readonly play_ = h('button', { type: 'button', class: 'timeline-play' }, '▶');
  private readonly rate_ = h(
    'select',
    { class: 'timeline-rate', 'aria-label': t('Playback speed') },
    ...RATES.map((rate) => h('option', { value: String(rate) }, `× ${rate}`)),
  );
  private readonly live_ = h('button', { type: 'button', class: 'timeline-live' }, t('Live'));
  readonly element: HTMLElement;
  private rateNow_ = 0;

  constructor(private readonly actions: TransportActions) {
    const step = (motions: number): HTMLElement => {
      const size = Math.abs(motions);
      const back = size === 1 ? t('Back 1 step') : t('Back {0} steps', size);
      const on = size === 1 ? t('Forward 1 step') : t('Forward {0} steps', size);
      const label = motions < 0 ? back : on;
      const attributes = { type: 'button', class: 'timeline-step', title: label };
      const button = h('button', { ...attributes, 'aria-label': label }, signed(motions));
      button.addEventListener('click', () => actions.step(motions));
      return button;
    };
    this.rate_.value = '4';
    this.element = h(
      'div',
      { class: 'timeline-transport', role: 'group', 'aria-label': t('Playback') },
      ...STEPS.map(step),
      this.play_,
      ...STEPS.map((motions) => step(-motions)).reverse(),
      this.rate_,
      actions.live ? this.live_ : '',
    );
    this.play_.addEventListener('click', () => this.toggle());
    this.live_.addEventListener('click', () => actions.live?.());
    this.rate_.addEventListener('change', () => {
      if (this.rateNow_ > 0) actions.play(Number(this.rate_.value));
    });
  }

  /** Plays, or rests if it plays. */
  toggle(): void {
    this.actions.play(this.rateNow_ > 0 ? 0 : Number(this.rate_.value));
  }

  /** @param rate with which the block plays; 0: it rests */
  update(rate: number, isLive: boolean): void {
    this.rateNow_ = rate;
    setText(this.play_, rate > 0 ? '❚❚' : '▶');
    const label = rate > 0 ? t('Pause') : t('Play');
    if (this.play_.getAttribute('aria-label') !== label) {
      this.play_.setAttribute('aria-label', label);
      this.play_.title = t('{0} (Space)', label);
    }
    const pressed = String(isLive);
    if (this.live_.getAttribute('aria-pressed') !== pressed) {
      this.live_.setAttribute('aria-pressed', pressed);
      this.live_.title = isLive ? t('You are viewing the present') : t('Back to live (End)');
    }
    setText(this.live_, isLive ? t('Live') : t('Back to live'));
  }
}
