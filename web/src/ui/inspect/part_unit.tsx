// SPDX-License-Identifier: Apache-2.0
// The question for the unit of a part whose size is unlikely: a button for each unit, with the size
// that the part has in it.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import type { SentPart, UnitAnswer } from '../../link/targets';
import { lengthText } from '../../model/measure';

function greatestSide({ min_mm: min, max_mm: max }: SentPart): number {
  return Math.max(...[0, 1, 2].map((n) => max[n]! - min[n]!));
}

function nameOf({ unit, scale }: UnitAnswer): string {
  return unit ?? `× ${scale}`;
}

export class PartUnit {
  /** The units to choose from, first the one that was taken; empty: there is no question. */
  readonly choices = signal<readonly UnitAnswer[]>([]);

  /** @param answered the unit of the part that was asked about last */
  constructor(private readonly answered: (answer: UnitAnswer) => void) {}

  /** Asks for the unit of a part if its size is unlikely; null: no part, no question. */
  ask(part: SentPart | null): void {
    const choices = part?.questions?.[0]?.choices ?? [];
    const hasQuestion = part !== null && choices.length > 0;
    this.choices.value = hasQuestion
      ? [{ unit: 'mm', size_mm: greatestSide(part) }, ...choices]
      : [];
  }

  answer(answer: UnitAnswer): void {
    this.ask(null);
    this.answered(answer);
  }
}

export function PartUnitView({ unit }: { unit: PartUnit }) {
  const { value: choices } = unit.choices;
  if (choices.length === 0) return null;
  return (
    <div>
      <p role="alert" class="bad">
        {t('Is this the right size? Choose the unit.')}
      </p>
      <div class="inspect-row">
        {choices.map((choice) => (
          <button
            key={nameOf(choice)}
            type="button"
            class="inspect-action"
            onClick={() => unit.answer(choice)}
          >
            {`${nameOf(choice)}: ${lengthText(choice.size_mm, 'mm')}`}
          </button>
        ))}
      </div>
    </div>
  );
}
