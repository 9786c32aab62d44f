// SPDX-License-Identifier: Apache-2.0
// A press on the surface asks the server where it is exactly, and who cut it.

import { t } from '../../strings';
import type { Probe } from '../../link/probe';
import { inUnit } from '../../model/measure';
import type { LengthUnit } from '../../model/measure';
import type { Vec3 } from '../../wire/types';
import { h, setText } from '../dom';
import type { CutNote } from './cut_note';
import type { Picked } from './picker';

/** A place to the digits that a quantum has. */
function placeText(at: Vec3, quantumMm: number, unit: LengthUnit): string {
  const digits = Math.min(6, Math.max(3, Math.ceil(-Math.log10(inUnit(quantumMm, unit) || 1))));
  const [x, y, z] = at.map((mm) => String(Number(inUnit(mm, unit).toFixed(digits))));
  return `X ${x!}  Y ${y!}  Z ${z!} ${unit}`;
}

export class Probing {
  /** The button is pressed: presses in the picture are taken. */
  chosen: () => void = () => undefined;
  private readonly button_ = h(
    'button',
    { type: 'button', class: 'inspect-action', 'aria-pressed': 'false' },
    t('Who cut this?'),
  );
  private readonly place_ = h('b', { class: 'probe-place' });
  readonly element: HTMLElement;
  private last_: Probe | null = null;
  private units_: LengthUnit = 'mm';

  constructor(private readonly note: CutNote) {
    this.button_.addEventListener('click', () => this.choose(!this.isOn));
    this.element = h(
      'section',
      { 'aria-label': t('Who cut this?') },
      h('div', { class: 'inspect-row' }, this.button_, this.place_),
      note.element,
    );
  }

  get isOn(): boolean {
    return this.button_.getAttribute('aria-pressed') === 'true';
  }

  choose(on: boolean): void {
    if (on) this.chosen();
    this.button_.setAttribute('aria-pressed', String(on));
    this.last_ = null;
    setText(this.place_, '');
    this.note.say(on ? t('Click the surface to see the exact position and who cut it.') : '');
  }

  setUnits(units: LengthUnit): void {
    this.units_ = units;
    if (this.last_) this.show_(this.last_);
  }

  async press({ point, normal }: Picked): Promise<void> {
    const found = await this.note.ask(point, normal);
    if (found) this.show_(found);
  }

  private show_(found: Probe): void {
    this.last_ = found;
    const { atMm, quantumMm } = found;
    setText(this.place_, atMm ? placeText(atMm, quantumMm, this.units_) : '');
  }
}
