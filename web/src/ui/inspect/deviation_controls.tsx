// SPDX-License-Identifier: Apache-2.0
// The controls of the comparison with a part: which one, the tolerance, the result.

import { useRef } from 'preact/hooks';
import { t } from '../../strings';
import { rangeOf, shareWithin } from '../../model/deviation';
import type { DeviationPlace, DeviationSurvey } from '../../model/deviation';
import { fromUnit, inUnit } from '../../model/measure';
import type { LengthUnit } from '../../model/measure';
import { useDrops } from '../drops';
import { figure } from '../format';
import type { Comparing } from './comparing';
import { CutNoteView } from './cut_note';
import { DeviationPlot, signed } from './deviation_plot';
import { LengthInput } from './length_input';
import { PartUnitView } from './part_unit';

const EXTENSIONS = '.stl,.ply,.obj,.3mf,.glb';

interface ActionProps {
  name: string;
  title: string;
  class?: string;
  hidden?: boolean;
  press: () => void;
}

function ActionButton({ name, title, class: more = '', hidden, press }: ActionProps) {
  return (
    <button
      type="button"
      class={`inspect-action ${more}`.trim()}
      title={title}
      hidden={hidden}
      onClick={press}
    >
      {name}
    </button>
  );
}

/** The part, and the buttons that add and remove parts. */
function PartChoice({ comparing }: { comparing: Comparing }) {
  const input = useRef<HTMLInputElement>(null);
  const { parts, chosen, mayChange } = comparing;
  return (
    <>
      <select
        class="deviation-choice"
        aria-label={t('Part to compare with')}
        hidden={parts.length === 0}
        value={chosen?.name ?? ''}
        onChange={({ currentTarget }) => comparing.choose(currentTarget.value || null)}
      >
        <option value="">{t('Off')}</option>
        {parts.map(({ name }) => (
          <option key={name} value={name}>
            {name}
          </option>
        ))}
      </select>
      <div class="inspect-row">
        <ActionButton
          name={t('Add a part…')}
          title={t('STL, PLY, OBJ, 3MF or GLB')}
          hidden={!mayChange}
          press={() => input.current?.click()}
        />
        <ActionButton
          name={t('Remove')}
          title={t('Remove the part from the session')}
          hidden={!mayChange || !chosen}
          press={() => {
            if (chosen) void comparing.remove(chosen.name);
          }}
        />
      </div>
      <input
        ref={input}
        type="file"
        accept={EXTENSIONS}
        hidden
        onChange={({ currentTarget }) => {
          const file = currentTarget.files?.[0];
          currentTarget.value = ''; // the same file may be chosen again
          if (file) comparing.add(file);
        }}
      />
    </>
  );
}

interface WorstProps {
  comparing: Comparing;
  survey: DeviationSurvey;
  units: LengthUnit;
}

/** The largest deviations, and a note on the one that was pressed. */
function Worst({ comparing, survey, units }: WorstProps) {
  const toleranceMm = comparing.toleranceMm.value;
  const beyond = survey.worst.filter(({ mm }) => Math.abs(mm) > toleranceMm);
  const button = (place: DeviationPlace) => (
    <ActionButton
      name={signed(place.mm, units)}
      title={t('Show this spot')}
      class={place.mm < 0 ? 'too-deep' : 'left-over'}
      press={() => comparing.goTo(place)}
    />
  );
  return (
    <div hidden={beyond.length === 0}>
      <h4>{t('Largest deviations')}</h4>
      <ol class="deviation-worst" aria-label={t('Largest deviations')}>
        {beyond.map((place, n) => (
          <li key={n}>{button(place)}</li>
        ))}
      </ol>
      <CutNoteView note={comparing.note} />
    </div>
  );
}

function Found({ comparing, survey, units }: WorstProps) {
  const toleranceMm = comparing.toleranceMm.value;
  const { quantiles_mm: quantiles, least_mm: least, greatest_mm: greatest, rms_mm: rms } = survey;
  const percent = 100 * shareWithin(quantiles, toleranceMm);
  return (
    <div class="deviation-found">
      <label class="inspect-row">
        {t('Tolerance ±')}
        {/* Long: four digits of an inch after zeros. */}
        <LengthInput
          class="inspect-number long"
          label={t('Tolerance')}
          min={0}
          value={Number(inUnit(toleranceMm, units).toPrecision(4))}
          enter={(value) => {
            if (value > 0) comparing.setTolerance(fromUnit(value, units));
          }}
        />
        <span class="quiet">{units}</span>
      </label>
      <p class="inspect-figures">
        <b>{t('{0} % within tolerance', figure(percent))}</b>
        <span>{t('{0} to {1} {2}', signed(least, units), signed(greatest, units), units)}</span>
        <span class="quiet">{t('RMS {0}', figure(inUnit(rms, units)))}</span>
      </p>
      <DeviationPlot
        quantiles={quantiles}
        tolerance={toleranceMm}
        range={rangeOf(survey, toleranceMm)}
        unit={units}
      />
      <Worst comparing={comparing} survey={survey} units={units} />
    </div>
  );
}

interface DeviationControlsProps {
  comparing: Comparing;
  units: LengthUnit;
}

export function DeviationControls({ comparing, units }: DeviationControlsProps) {
  const drops = useDrops(
    () => comparing.mayChange,
    (files) => {
      if (files?.[0]) comparing.add(files[0]);
    },
  );
  const { text, canCenter } = comparing.hint.value;
  const { value: survey } = comparing.survey;
  return (
    <section
      aria-label={t('Deviation')}
      class={drops.isOver ? 'deviation dropping' : 'deviation'}
      {...drops.handlers}
    >
      <h3>{t('Deviation from a part')}</h3>
      <PartChoice comparing={comparing} />
      <p class="quiet inspect-hint" role="status">
        {text}
      </p>
      <PartUnitView unit={comparing.unit} />
      <ActionButton
        name={t('Move it into the block')}
        title=""
        hidden={!canCenter}
        press={() => comparing.center()}
      />
      {survey && <Found comparing={comparing} survey={survey} units={units} />}
    </section>
  );
}
