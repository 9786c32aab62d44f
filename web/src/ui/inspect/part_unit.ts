// SPDX-License-Identifier: Apache-2.0
// The question for the unit of a part whose size is unlikely: a button for each unit, with the size
// that the part has in it.

import { t } from '../../strings';
import type { SentPart, UnitAnswer } from '../../link/targets';
import { lengthText } from '../../model/measure';
import { h } from '../dom';

function greatestSide({ min_mm: min, max_mm: max }: SentPart): number {
  return Math.max(...[0, 1, 2].map((n) => max[n]! - min[n]!));
}

function nameOf({ unit, scale }: UnitAnswer): string {
  return unit ?? `× ${scale}`;
}

export class PartUnit {
  readonly element = h('div', { class: 'part-unit', hidden: '' });

  /** @param answered the unit of the part that was asked about last */
  constructor(private readonly answered: (answer: UnitAnswer) => void) {}

  /** Asks for the unit of a part if its size is unlikely; null: no part, no question. */
  ask(part: SentPart | null): void {
    const choices = part?.questions?.[0]?.choices ?? [];
    this.element.hidden = choices.length === 0;
    if (!part || choices.length === 0) {
      this.element.replaceChildren();
      return;
    }
    const as = { unit: 'mm', size_mm: greatestSide(part) };
    this.element.replaceChildren(
      h('p', { role: 'alert', class: 'bad' }, t('Is this the right size? Choose the unit.')),
      h('div', { class: 'inspect-row' }, ...[as, ...choices].map((one) => this.button_(one))),
    );
  }

  private button_(answer: UnitAnswer): HTMLElement {
    const text = `${nameOf(answer)}: ${lengthText(answer.size_mm, 'mm')}`;
    const button = h('button', { type: 'button', class: 'inspect-action' }, text);
    button.addEventListener('click', () => {
      this.ask(null);
      this.answered(answer);
    });
    return button;
  }
}
