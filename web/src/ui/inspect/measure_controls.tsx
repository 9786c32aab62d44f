// SPDX-License-Identifier: Apache-2.0
// The controls of measuring: the kind of measure, the next step, and the result.

import { t } from '../../strings';
import { partsText, valueText } from '../../model/measure';
import type { LengthUnit, Measure } from '../../model/measure';
import { KINDS } from './measure_hint';
import type { Measuring } from './measuring';

const NAMES = new Map(KINDS.map(([kind, name]) => [kind, name]));

interface MeasureRowProps {
  measure: Measure;
  units: LengthUnit;
  remove: () => void;
}

function MeasureRow({ measure, units, remove }: MeasureRowProps) {
  const name = NAMES.get(measure.kind)!;
  const label = t('Remove: {0}', name);
  const parts = partsText(measure, units);
  return (
    <li>
      <span>
        {`${name} `}
        <b>{valueText(measure, units)}</b>
        {parts !== '' && <small class="quiet">{parts}</small>}
      </span>
      <button type="button" aria-label={label} title={label} onClick={remove}>
        ×
      </button>
    </li>
  );
}

interface MeasureControlsProps {
  measuring: Measuring;
  units: LengthUnit;
}

export function MeasureControls({ measuring, units }: MeasureControlsProps) {
  const { value: chosen } = measuring.kind;
  const { value: measures } = measuring.measures;
  return (
    <section aria-label={t('Measure')}>
      <h3>{t('Measure')}</h3>
      <div class="inspect-choice" role="group" aria-label={t('What to measure')}>
        {KINDS.map(([kind, name, hint]) => (
          <button
            key={kind}
            type="button"
            aria-pressed={kind === chosen}
            title={hint}
            onClick={() => measuring.choose(kind === chosen ? null : kind)}
          >
            {name}
          </button>
        ))}
      </div>
      <p class="quiet inspect-hint" role="status">
        {measuring.hint.value}
      </p>
      <ul class="inspect-list" aria-label={t('Measurements')}>
        {measures.map((measure, n) => (
          <MeasureRow
            key={n}
            measure={measure}
            units={units}
            remove={() => measuring.remove(measure)}
          />
        ))}
      </ul>
      <button
        type="button"
        class="inspect-action"
        hidden={measures.length < 2}
        onClick={() => measuring.clear()}
      >
        {t('Remove all')}
      </button>
    </section>
  );
}
