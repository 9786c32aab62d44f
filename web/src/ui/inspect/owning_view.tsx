// SPDX-License-Identifier: Apache-2.0

import { t } from '../../strings';
import { figure } from '../format';
import type { Owning } from './owning';

/** The button that colors the surface by who cut it, and the legend. */
export function OwningView({ owning }: { owning: Owning }) {
  const { isOn } = owning;
  const { value: hint } = owning.hint;
  const { value: alone } = owning.alone;
  return (
    <section aria-label={t('Who cut what')} class="owners">
      <div class="inspect-row">
        <button
          type="button"
          class="inspect-action"
          aria-pressed={isOn}
          onClick={() => owning.choose(!isOn)}
        >
          {t('Color by participant')}
        </button>
      </div>
      <p class="quiet inspect-hint" role="status" hidden={hint === ''}>
        {hint}
      </p>
      <ul class="owner-legend" aria-label={t('Who cut what')}>
        {owning.legend.value.map(({ slot, name, color, percent }) => (
          <li key={slot}>
            <button
              type="button"
              aria-pressed={alone === slot}
              title={t('Show what {0} cut', name)}
              onClick={() => owning.setAlone(alone === slot ? null : slot)}
            >
              <span class="owner-color" style={`background:${color}`} aria-hidden="true" />
              <span class="owner-name">{name}</span>
              <span class="owner-share">{`${figure(percent)} %`}</span>
            </button>
          </li>
        ))}
      </ul>
      <p class="quiet inspect-hint" hidden={!isOn}>
        {t('Point at or click a spot to see who cut it. Press Enter for the middle of the view.')}
      </p>
    </section>
  );
}
