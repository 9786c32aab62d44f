// SPDX-License-Identifier: Apache-2.0
// The buttons of one program: pause and resume, step, speed, cancel.

import { t } from '../../strings';
import { isOpen } from '../../model/programs';
import type { ProgramInfo } from '../../wire/types';
import { h, setText } from '../dom';

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20];
const FAST = 'fast';

export interface ControlActions {
  /** A query of PATCH, as in server/http/README.md. */
  change: (query: string) => void;
  cancel: () => void;
}

export class Controls {
  private readonly play_ = h(
    'button',
    { type: 'button', class: 'button program-play' },
    t('Pause'),
  );
  private readonly step_ = h(
    'button',
    {
      type: 'button',
      class: 'button quiet-button',
      title: t('Run one line, then pause'),
    },
    t('Step'),
  );
  private readonly cancel_ = h(
    'button',
    { type: 'button', class: 'button quiet-button' },
    t('Cancel'),
  );
  private readonly speed_ = h(
    'select',
    { class: 'program-speed', 'aria-label': t('Speed') },
    ...SPEEDS.map((speed) => h('option', { value: String(speed) }, `× ${speed}`)),
    h('option', { value: FAST }, t('Full speed')),
  );
  readonly element = h(
    'div',
    { class: 'program-controls', role: 'group', 'aria-label': t('Program controls') },
    this.play_,
    this.step_,
    this.speed_,
    this.cancel_,
  );
  private paused_ = false;

  constructor(actions: ControlActions) {
    this.play_.addEventListener('click', () =>
      actions.change(this.paused_ ? 'do=resume' : 'do=pause'),
    );
    this.step_.addEventListener('click', () => actions.change('do=step'));
    this.cancel_.addEventListener('click', () => actions.cancel());
    this.speed_.addEventListener('change', () =>
      actions.change(this.speed_.value === FAST ? 'pace=fast' : `speed=${this.speed_.value}`),
    );
  }

  update(program: ProgramInfo, may: boolean): void {
    const runs = program.state === 'running' || program.state === 'paused';
    this.paused_ = program.state === 'paused';
    setText(this.play_, this.paused_ ? t('Resume') : t('Pause'));
    this.play_.disabled = !may || !runs;
    this.step_.disabled = !may || !runs;
    this.speed_.disabled = !may || !isOpen(program);
    this.cancel_.disabled = !may || !isOpen(program);
    if (document.activeElement === this.speed_) return; // it is being chosen
    this.show_(program.pace === 'fast' ? FAST : String(program.speed ?? 1));
  }

  /** Shows a speed that another client may have chosen freely. */
  private show_(value: string): void {
    if (this.speed_.value === value) return;
    if (![...this.speed_.options].some((option) => option.value === value))
      this.speed_.append(h('option', { value }, `× ${value}`));
    this.speed_.value = value;
  }
}
