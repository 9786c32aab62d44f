// SPDX-License-Identifier: Apache-2.0
// Which part a program is to make: cuts below it are alarms while the program runs.

import { t } from '../../strings';
import { listTargets } from '../../link/targets';
import { h } from '../dom';
import { partTolerance, rememberPartTolerance } from '../part_tolerance';

export class TargetChoice {
  private readonly part_ = h('select', {
    class: 'program-speed',
    'aria-label': t('Part the program makes'),
  });
  private readonly tolerance_ = h('input', {
    type: 'number',
    class: 'program-tolerance',
    min: '0',
    step: 'any',
    'aria-label': t('Tolerance'),
  });
  private readonly label_ = h('label', {}, ' ± ', this.tolerance_, ' mm');
  readonly element = h('p', { class: 'program-options', hidden: '' }, this.part_, this.label_);
  /** The user has chosen that no part is to be watched. */
  private isOff_ = false;

  constructor(private readonly session: string) {
    this.part_.addEventListener('change', () => {
      this.isOff_ = this.part_.value === '';
      this.label_.hidden = this.isOff_;
    });
    this.tolerance_.addEventListener('change', () => {
      const mm = Number(this.tolerance_.value);
      if (mm > 0) rememberPartTolerance(mm);
    });
  }

  /** Asks for the parts, which others may have changed. Rejects with a ServerError. */
  async update(pitchMm: number | undefined): Promise<void> {
    const parts = await listTargets(this.session);
    const chosen = this.part_.value;
    this.part_.replaceChildren(
      h('option', { value: '' }, t("don't watch for gouges")),
      ...parts.map(({ name }) =>
        h('option', { value: name }, t('watch for gouges into {0}', name)),
      ),
    );
    const kept = parts.some(({ name }) => name === chosen) ? chosen : (parts[0]?.name ?? '');
    this.part_.value = this.isOff_ ? '' : kept;
    this.label_.hidden = this.part_.value === '';
    this.element.hidden = parts.length === 0;
    if (document.activeElement !== this.tolerance_)
      this.tolerance_.value = String(partTolerance(pitchMm));
  }

  /** The part of the query that starts a program; empty: no part is watched. */
  get query(): string {
    const mm = Number(this.tolerance_.value);
    if (this.part_.value === '') return '';
    const tolerance = mm > 0 ? `&target_tolerance_mm=${mm}` : '';
    return `&target=${encodeURIComponent(this.part_.value)}${tolerance}`;
  }
}
