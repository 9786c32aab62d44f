// SPDX-License-Identifier: Apache-2.0
// The alarms of a program as buttons. The server extends the last alarms while a program moves, so
// the texts of the rows change in place.

import { t } from '../../strings';
import { h, setText } from '../dom';
import type { Alarm } from './requests';
import { alarmText } from './texts';

export class AlarmList {
  readonly element = h('ul', { class: 'program-alarms', 'aria-label': t('Alarms') });
  private readonly buttons_: HTMLElement[] = [];
  private alarms_: readonly Alarm[] = [];

  constructor(private readonly pressed: (alarm: Alarm) => void) {}

  update(alarms: readonly Alarm[]): void {
    this.alarms_ = alarms;
    while (this.buttons_.length > alarms.length) this.buttons_.pop()?.parentElement?.remove();
    while (this.buttons_.length < alarms.length) this.add_(this.buttons_.length);
    alarms.forEach((alarm, at) => {
      const button = this.buttons_[at];
      if (button) setText(button, alarmText(alarm));
    });
  }

  private add_(at: number): void {
    const button = h('button', { type: 'button' });
    button.addEventListener('click', () => {
      const alarm = this.alarms_[at];
      if (alarm) this.pressed(alarm);
    });
    this.buttons_.push(button);
    this.element.append(h('li', {}, button));
  }
}
