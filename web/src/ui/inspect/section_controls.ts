// SPDX-License-Identifier: Apache-2.0
// The controls of the section plane: its direction, place and side, and the area it cuts.

import { t } from '../../strings';
import type { LengthUnit } from '../../model/measure';
import { areaText, fromUnit, inUnit, lengthText } from '../../model/measure';
import type { Section } from '../../model/section';
import { h, setText } from '../dom';

export type Direction = 'none' | 'x' | 'y' | 'z' | 'face';

const DIRECTIONS: readonly [Direction, string, string][] = [
  ['none', t('Off'), t('No section')],
  ['x', 'X', t('Section across X')],
  ['y', 'Y', t('Section across Y')],
  ['z', 'Z', t('Section across Z')],
  ['face', t('Face…'), t('Section along a face: pick one in the view')],
];

export interface SectionActions {
  direction: (direction: Direction) => void;
  /** mm along the direction */
  place: (mm: number) => void;
  flip: () => void;
  /** Look straight at the section. */
  face: () => void;
}

export class SectionControls {
  private readonly directions_: HTMLButtonElement[];
  private readonly range_ = h('input', {
    type: 'range',
    class: 'inspect-range',
    step: 'any',
    'aria-label': t('Section position'),
  });
  private readonly number_ = h('input', {
    type: 'number',
    class: 'inspect-number',
    step: 'any',
    'aria-label': t('Section position'),
  });
  private readonly unit_ = h('span', { class: 'quiet' });
  private readonly placed_: HTMLElement;
  private readonly area_ = h('span');
  private readonly outline_ = h('span', { class: 'quiet' });
  readonly element: HTMLElement;
  private units_: LengthUnit = 'mm';

  constructor(actions: SectionActions) {
    this.directions_ = DIRECTIONS.map(([direction, name, title]) => {
      const button = h('button', { type: 'button', title }, name);
      if (name.length === 1) button.setAttribute('aria-label', title);
      button.addEventListener('click', () => actions.direction(direction));
      return button;
    });
    const button = (name: string, title: string, act: () => void): HTMLElement => {
      const one = h('button', { type: 'button', class: 'inspect-action', title }, name);
      one.addEventListener('click', act);
      return one;
    };
    this.range_.addEventListener('input', () => actions.place(Number(this.range_.value)));
    this.number_.addEventListener('change', () => {
      const value = this.number_.valueAsNumber;
      if (Number.isFinite(value)) actions.place(fromUnit(value, this.units_));
    });
    this.placed_ = h(
      'div',
      { class: 'inspect-placed', hidden: '' },
      h('div', { class: 'inspect-row' }, this.range_),
      h(
        'div',
        { class: 'inspect-row' },
        this.number_,
        this.unit_,
        button(t('Flip'), t('Hide the other side'), actions.flip),
        button(t('Face on'), t('Look straight at the section'), actions.face),
      ),
      h('p', { class: 'inspect-figures' }, this.area_, this.outline_),
    );
    this.element = h(
      'section',
      { 'aria-label': t('Section') },
      h('h3', {}, t('Section')),
      h(
        'div',
        { class: 'inspect-choice', role: 'group', 'aria-label': t('Section direction') },
        ...this.directions_,
      ),
      this.placed_,
    );
  }

  showDirection(direction: Direction, [least, greatest]: [number, number]): void {
    this.directions_.forEach((button, n) =>
      button.setAttribute('aria-pressed', String(DIRECTIONS[n]![0] === direction)),
    );
    this.range_.min = String(least);
    this.range_.max = String(greatest);
  }

  /** @param mm null: there is no section */
  showPlace(mm: number | null, units: LengthUnit): void {
    this.units_ = units;
    this.placed_.hidden = mm === null;
    if (mm === null) return;
    setText(this.area_, t('Area…')); // until it is computed
    this.range_.value = String(mm);
    this.number_.value = String(Number(inUnit(mm, units).toFixed(units === 'mm' ? 3 : 4)));
    setText(this.unit_, units);
  }

  /** @param isExact no displayed tile is coarser than the block */
  showArea({ areaMm2, outlineMm }: Section, isExact: boolean): void {
    const about = isExact ? '' : '≈ ';
    setText(this.area_, t('Area {0}{1}', about, areaText(areaMm2, this.units_)));
    setText(this.outline_, t('Outline {0}{1}', about, lengthText(outlineMm, this.units_)));
  }
}
