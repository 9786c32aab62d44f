// SPDX-License-Identifier: Apache-2.0
// A press on the surface asks the server where it is exactly, and who cut it.

import { t } from '../../strings';
import { probe } from '../../link/probe';
import type { Cut, Probe } from '../../link/probe';
import { inUnit } from '../../model/measure';
import type { LengthUnit } from '../../model/measure';
import type { SessionModel } from '../../model/session';
import type { Vec3 } from '../../wire/types';
import { h, setText } from '../dom';
import { sentence } from '../format';
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
  private readonly text_ = h('p', { class: 'quiet inspect-hint probe-text', role: 'status' });
  readonly element: HTMLElement;
  private last_: Probe | null = null;
  private units_: LengthUnit = 'mm';
  private asked_ = 0;

  constructor(
    private readonly model: SessionModel,
    private readonly session: string,
  ) {
    this.button_.addEventListener('click', () => this.choose(!this.isOn));
    this.element = h(
      'section',
      { 'aria-label': t('Who cut this?') },
      h('div', { class: 'inspect-row' }, this.button_, this.place_),
      this.text_,
    );
  }

  get isOn(): boolean {
    return this.button_.getAttribute('aria-pressed') === 'true';
  }

  choose(on: boolean): void {
    if (on) this.chosen();
    this.button_.setAttribute('aria-pressed', String(on));
    this.last_ = null;
    this.asked_ += 1; // what was asked is of no interest any more
    setText(this.place_, '');
    setText(this.text_, on ? t('Press the surface: its exact place, and who cut it.') : '');
  }

  setUnits(units: LengthUnit): void {
    this.units_ = units;
    if (this.last_) this.show_(this.last_);
  }

  async press({ point, normal }: Picked): Promise<void> {
    this.asked_ += 1;
    const asked = this.asked_;
    setText(this.text_, t('Asking…'));
    try {
      const found = await probe(this.session, point, normal, this.model.state?.at?.record ?? null);
      if (asked === this.asked_) this.show_(found);
    } catch (problem) {
      if (asked === this.asked_) setText(this.text_, sentence((problem as Error).message));
    }
  }

  private show_(found: Probe): void {
    this.last_ = found;
    const { atMm, quantumMm, cut } = found;
    setText(this.place_, atMm ? placeText(atMm, quantumMm, this.units_) : '');
    setText(this.text_, cut ? this.cutText_(cut) : t('The surface of the stock as it was.'));
  }

  private cutText_({ participant, tool, record, program }: Cut): string {
    const known = this.model.participants.get(participant)?.info.name;
    const name = program?.name ?? known ?? t('Participant {0}', participant);
    return program && program.line > 0
      ? t('Cut by {0} in line {1}, with tool {2}, in record {3}.', name, program.line, tool, record)
      : t('Cut by {0} with tool {1}, in record {2}.', name, tool, record);
  }
}
