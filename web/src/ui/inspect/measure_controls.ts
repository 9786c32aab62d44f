// SPDX-License-Identifier: Apache-2.0
// The controls of measuring: the kind of measure, the next step, and the result.

import { t } from '../../strings';
import { partsText, POINTS_OF, valueText } from '../../model/measure';
import type { LengthUnit, Measure, MeasureKind } from '../../model/measure';
import { h, setText } from '../dom';

const KINDS: readonly [MeasureKind, string, string][] = [
  ['distance', t('Distance'), t('Pick two points. They snap to corners and edges.')],
  ['thickness', t('Thickness'), t('Pick a wall to measure straight through it.')],
  ['depth', t('Depth'), t('Pick a point to measure its depth below the top of the stock.')],
  ['radius', t('Radius'), t('Pick three points on a rounded edge or a hole.')],
  ['angle', t('Angle'), t('Pick two faces to measure the angle of the material between them.')],
];
const NAMES = new Map(KINDS.map(([kind, name]) => [kind, name]));

export interface MeasureActions {
  /** null: nothing is measured */
  choose: (kind: MeasureKind | null) => void;
  remove: (measure: Measure) => void;
  clear: () => void;
}

export class MeasureControls {
  private readonly kinds_: HTMLButtonElement[];
  private readonly hint_ = h('p', { class: 'quiet inspect-hint', role: 'status' });
  private readonly list_ = h('ul', { class: 'inspect-list', 'aria-label': t('Measurements') });
  private readonly clear_ = h(
    'button',
    { type: 'button', class: 'inspect-action', hidden: '' },
    t('Remove all'),
  );
  readonly element: HTMLElement;
  private kind_: MeasureKind | null = null;

  constructor(private readonly actions: MeasureActions) {
    this.kinds_ = KINDS.map(([kind, name, hint]) => {
      const button = h('button', { type: 'button', 'aria-pressed': 'false', title: hint }, name);
      button.addEventListener('click', () => actions.choose(this.kind_ === kind ? null : kind));
      return button;
    });
    this.clear_.addEventListener('click', () => actions.clear());
    this.element = h(
      'section',
      { 'aria-label': t('Measure') },
      h('h3', {}, t('Measure')),
      h(
        'div',
        { class: 'inspect-choice', role: 'group', 'aria-label': t('What to measure') },
        ...this.kinds_,
      ),
      this.hint_,
      this.list_,
      this.clear_,
    );
  }

  /** @param pressed how many points were pressed so far */
  showKind(kind: MeasureKind | null, pressed: number): void {
    this.kind_ = kind;
    this.kinds_.forEach((button, n) =>
      button.setAttribute('aria-pressed', String(KINDS[n]![0] === kind)),
    );
    const hint = KINDS.find(([one]) => one === kind)?.[2] ?? '';
    const of = kind && pressed > 0 ? t(' Point {0} of {1}.', pressed + 1, POINTS_OF[kind]) : '';
    this.say(hint + of);
  }

  say(text: string): void {
    setText(this.hint_, text);
  }

  showMeasures(measures: readonly Measure[], unit: LengthUnit): void {
    this.clear_.hidden = measures.length < 2;
    this.list_.replaceChildren(
      ...measures.map((measure) => {
        const name = NAMES.get(measure.kind)!;
        const label = t('Remove: {0}', name);
        const remove = h('button', { type: 'button', 'aria-label': label, title: label }, '×');
        remove.addEventListener('click', () => this.actions.remove(measure));
        const parts = partsText(measure, unit);
        const more = parts === '' ? [] : [h('small', { class: 'quiet' }, parts)];
        return h(
          'li',
          {},
          h('span', {}, `${name} `, h('b', {}, valueText(measure, unit)), ...more),
          remove,
        );
      }),
    );
  }
}
