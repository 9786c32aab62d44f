// SPDX-License-Identifier: Apache-2.0
// A press on the surface asks the server where it is exactly, and who cut it.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import type { Probe } from '../../link/probe';
import { inUnit } from '../../model/measure';
import type { LengthUnit } from '../../model/measure';
import type { Vec3 } from '../../wire/types';
import { CutNoteView } from './cut_note';
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
  readonly isOn = signal(false);
  /** The place that was pressed last; null: none. */
  readonly found = signal<Probe | null>(null);

  constructor(readonly note: CutNote) {}

  choose(on: boolean): void {
    if (on) this.chosen();
    this.isOn.value = on;
    this.found.value = null;
    this.note.say(on ? t('Click the surface to see the exact position and who cut it.') : '');
  }

  async press({ point, normal }: Picked): Promise<void> {
    const found = await this.note.ask(point, normal);
    if (found) this.found.value = found;
  }
}

interface ProbingViewProps {
  probing: Probing;
  units: LengthUnit;
}

export function ProbingView({ probing, units }: ProbingViewProps) {
  const { atMm, quantumMm } = probing.found.value ?? {};
  const isOn = probing.isOn.value;
  return (
    <section aria-label={t('Who cut this?')}>
      <div class="inspect-row">
        <button
          type="button"
          class="inspect-action"
          aria-pressed={isOn}
          onClick={() => probing.choose(!isOn)}
        >
          {t('Who cut this?')}
        </button>
        <b class="probe-place">{atMm && placeText(atMm, quantumMm ?? 0, units)}</b>
      </div>
      <CutNoteView note={probing.note} />
    </section>
  );
}
