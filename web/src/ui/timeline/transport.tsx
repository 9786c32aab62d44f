// SPDX-License-Identifier: Apache-2.0
// The buttons of the timeline: steps, play and pause, speed, back to live.

import { signal } from '@preact/signals';
import { t } from '../../strings';

const STEPS = [-1000, -100, -1, 1, 100, 1000] as const;
const RATES = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];

export interface TransportActions {
  step: (motions: number) => void;
  /** Plays with a rate, or rests with 0. */
  play: (rate: number) => void;
  /** Missing where there is no present. */
  live?: () => void;
}

export class Transport {
  /** The rate with which the block plays; 0: it rests. */
  readonly rate = signal(0);
  /** The rate that the user has chosen. */
  readonly chosen = signal(4);
  readonly isLive = signal(false);

  constructor(readonly actions: TransportActions) {}

  /** Plays, or rests if it plays. */
  toggle(): void {
    this.actions.play(this.rate.peek() > 0 ? 0 : this.chosen.peek());
  }

  choose(rate: number): void {
    this.chosen.value = rate;
    if (this.rate.peek() > 0) this.actions.play(rate);
  }
}

function StepButton({ motions, step }: { motions: number; step: (motions: number) => void }) {
  const size = Math.abs(motions);
  const back = size === 1 ? t('Back 1 step') : t('Back {0} steps', size);
  const on = size === 1 ? t('Forward 1 step') : t('Forward {0} steps', size);
  const label = motions < 0 ? back : on;
  return (
    <button
      type="button"
      class="timeline-step"
      title={label}
      aria-label={label}
      onClick={() => step(motions)}
    >
      {motions < 0 ? `−${size}` : `+${size}`}
    </button>
  );
}

function PlayButton({ transport }: { transport: Transport }) {
  const plays = transport.rate.value > 0;
  const label = plays ? t('Pause') : t('Play');
  return (
    <button
      type="button"
      class="timeline-play"
      aria-label={label}
      title={t('{0} (Space)', label)}
      onClick={() => transport.toggle()}
    >
      {plays ? '❚❚' : '▶'}
    </button>
  );
}

export function TransportView({ transport }: { transport: Transport }) {
  const { step, live } = transport.actions;
  const isLive = transport.isLive.value;
  const button = (motions: number) => <StepButton key={motions} motions={motions} step={step} />;
  return (
    <div class="timeline-transport" role="group" aria-label={t('Playback')}>
      {STEPS.filter((motions) => motions < 0).map(button)}
      <PlayButton transport={transport} />
      {STEPS.filter((motions) => motions > 0).map(button)}
      <select
        class="timeline-rate"
        aria-label={t('Playback speed')}
        value={String(transport.chosen.value)}
        onChange={({ currentTarget }) => transport.choose(Number(currentTarget.value))}
      >
        {RATES.map((rate) => (
          <option key={rate} value={String(rate)}>{`× ${rate}`}</option>
        ))}
      </select>
      {live && (
        <button
          type="button"
          class="timeline-live"
          aria-pressed={isLive}
          title={isLive ? t('You are viewing the present') : t('Back to live (End)')}
          onClick={live}
        >
          {isLive ? t('Live') : t('Back to live')}
        </button>
      )}
    </div>
  );
}
