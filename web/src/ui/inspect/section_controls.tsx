// SPDX-License-Identifier: Apache-2.0
// The controls of the section plane: its direction, place and side, and the area it cuts.

import { t } from '../../strings';
import type { LengthUnit } from '../../model/measure';
import { areaText, fromUnit, inUnit, lengthText } from '../../model/measure';
import type { Section } from '../../model/section';
import { LengthInput } from './length_input';

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

/** The section as the controls show it. */
export interface ShownSection {
  direction: Direction;
  /** The least and the greatest place, mm along the direction. */
  range: readonly [number, number];
  /** Null: there is no section. */
  mm: number | null;
  /** Null until it is computed. */
  section: Section | null;
  /** No displayed tile is coarser than the block. */
  isExact: boolean;
}

interface SectionControlsProps {
  shown: ShownSection;
  units: LengthUnit;
  actions: SectionActions;
}

function Directions({ shown, actions }: SectionControlsProps) {
  return (
    <div class="inspect-choice" role="group" aria-label={t('Section direction')}>
      {DIRECTIONS.map(([direction, name, title]) => (
        <button
          key={direction}
          type="button"
          title={title}
          aria-label={name.length === 1 ? title : undefined}
          aria-pressed={direction === shown.direction}
          onClick={() => actions.direction(direction)}
        >
          {name}
        </button>
      ))}
    </div>
  );
}

function Figures({ shown: { section, isExact }, units }: SectionControlsProps) {
  const about = isExact ? '' : '≈ ';
  return (
    <p class="inspect-figures">
      <span>
        {section ? t('Area {0}{1}', about, areaText(section.areaMm2, units)) : t('Area…')}
      </span>
      <span class="quiet">
        {section && t('Outline {0}{1}', about, lengthText(section.outlineMm, units))}
      </span>
    </p>
  );
}

function Place(props: SectionControlsProps) {
  const { shown, units, actions } = props;
  const { mm, range } = shown;
  const place = Number(inUnit(mm ?? 0, units).toFixed(units === 'mm' ? 3 : 4));
  return (
    <div class="inspect-placed" hidden={mm === null}>
      <div class="inspect-row">
        <input
          type="range"
          class="inspect-range"
          step="any"
          aria-label={t('Section position')}
          min={range[0]}
          max={range[1]}
          value={mm ?? 0}
          onInput={({ currentTarget }) => actions.place(Number(currentTarget.value))}
        />
      </div>
      <div class="inspect-row">
        <LengthInput
          class="inspect-number"
          label={t('Section position')}
          value={place}
          enter={(value) => actions.place(fromUnit(value, units))}
        />
        <span class="quiet">{units}</span>
        <button
          type="button"
          class="inspect-action"
          title={t('Hide the other side')}
          onClick={actions.flip}
        >
          {t('Flip')}
        </button>
        <button
          type="button"
          class="inspect-action"
          title={t('Look straight at the section')}
          onClick={actions.face}
        >
          {t('Face on')}
        </button>
      </div>
      <Figures {...props} />
    </div>
  );
}

export function SectionControls(props: SectionControlsProps) {
  return (
    <section aria-label={t('Section')}>
      <h3>{t('Section')}</h3>
      <Directions {...props} />
      <Place {...props} />
    </section>
  );
}
