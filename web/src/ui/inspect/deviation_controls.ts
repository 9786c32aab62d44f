// SPDX-License-Identifier: Apache-2.0
// The controls of the comparison with a part: which one, the tolerance, the result.

import { t } from '../../strings';
import type { TargetPart } from '../../link/targets';
import { rangeOf, shareWithin } from '../../model/deviation';
import type { DeviationPlace, DeviationSurvey } from '../../model/deviation';
import { fromUnit, inUnit } from '../../model/measure';
import type { LengthUnit } from '../../model/measure';
import { h, setText } from '../dom';
import { figure, sentence } from '../format';
import { DeviationPlot, signed } from './deviation_plot';

const EXTENSIONS = '.stl,.ply,.obj,.3mf,.glb';

export interface DeviationActions {
  /** Null: none. */
  choose: (name: string | null) => void;
  added: (file: File) => void;
  remove: (name: string) => void;
  /** Move the part into the block. */
  center: () => void;
  tolerance: (mm: number) => void;
  place: (place: DeviationPlace) => void;
}

function button(name: string, title: string, act: () => void): HTMLButtonElement {
  const one = h('button', { type: 'button', class: 'inspect-action', title }, name);
  one.addEventListener('click', act);
  return one;
}

export class DeviationControls {
  private readonly choice_ = h('select', {
    class: 'deviation-choice',
    'aria-label': t('Part to compare with'),
  });
  private readonly file_ = h('input', { type: 'file', accept: EXTENSIONS, hidden: '' });
  private readonly add_: HTMLButtonElement;
  private readonly remove_: HTMLButtonElement;
  private readonly center_: HTMLButtonElement;
  private readonly hint_ = h('p', { class: 'quiet inspect-hint', role: 'status' });
  private readonly tolerance_ = h('input', {
    type: 'number',
    class: 'inspect-number long', // four digits of an inch behind zeros
    min: '0',
    step: 'any',
    'aria-label': t('Tolerance'),
  });
  private readonly unit_ = h('span', { class: 'quiet' });
  private readonly within_ = h('b');
  private readonly span_ = h('span');
  private readonly rms_ = h('span', { class: 'quiet' });
  private readonly plot_ = new DeviationPlot();
  private readonly worst_ = h('ol', {
    class: 'deviation-worst',
    'aria-label': t('Largest deviations'),
  });
  /** The worst points, and a note on the one that was pressed. */
  readonly places = h('div', {}, h('h4', {}, t('Largest deviations')), this.worst_);
  /** The hint, and questions about the part. */
  readonly hints = h('div', {}, this.hint_);
  private readonly found_: HTMLElement;
  readonly element: HTMLElement;
  private units_: LengthUnit = 'mm';

  constructor(private readonly actions: DeviationActions) {
    this.add_ = button(t('Add a part…'), t('STL, PLY, OBJ, 3MF or GLB'), () => this.file_.click());
    this.remove_ = button(t('Remove'), t('Remove the part from the session'), () =>
      actions.remove(this.choice_.value),
    );
    this.center_ = button(t('Move it into the block'), '', () => actions.center());
    this.file_.addEventListener('change', () => {
      const file = this.file_.files?.[0];
      this.file_.value = ''; // the same file may be chosen again
      if (file) actions.added(file);
    });
    this.choice_.addEventListener('change', () => actions.choose(this.choice_.value || null));
    this.tolerance_.addEventListener('change', () => {
      const value = this.tolerance_.valueAsNumber;
      if (value > 0) actions.tolerance(fromUnit(value, this.units_));
    });
    this.found_ = this.makeFound_();
    this.element = h(
      'section',
      { 'aria-label': t('Deviation'), class: 'deviation' },
      h('h3', {}, t('Deviation from a part')),
      this.choice_,
      h('div', { class: 'inspect-row' }, this.add_, this.remove_),
      this.file_,
      this.hints,
      this.center_,
      this.found_,
    );
    this.listenToDrops_();
  }

  /** @param mayChange whether parts may be added and removed */
  showParts(parts: readonly TargetPart[], chosen: string | null, mayChange: boolean): void {
    const names = parts.map(({ name }) => h('option', { value: name }, name));
    this.choice_.replaceChildren(h('option', { value: '' }, t('Off')), ...names);
    this.choice_.value = chosen ?? '';
    this.choice_.hidden = parts.length === 0;
    this.add_.hidden = !mayChange;
    this.remove_.hidden = !mayChange || chosen === null;
  }

  /** @param canCenter whether the part can be moved into the block */
  say(text: string, canCenter = false): void {
    setText(this.hint_, text === '' ? '' : sentence(text));
    this.center_.hidden = !canCenter;
  }

  /** Null: nothing is known. */
  showSurvey(survey: DeviationSurvey | null, toleranceMm: number, units: LengthUnit): void {
    this.units_ = units;
    this.found_.hidden = survey === null;
    setText(this.unit_, units);
    const shown = String(Number(inUnit(toleranceMm, units).toPrecision(4)));
    if (document.activeElement !== this.tolerance_) this.tolerance_.value = shown;
    if (!survey) return;
    const { quantiles_mm: quantiles, least_mm: least, greatest_mm: greatest } = survey;
    const percent = 100 * shareWithin(quantiles, toleranceMm);
    setText(this.within_, t('{0} % within tolerance', figure(percent)));
    setText(this.span_, t('{0} to {1} {2}', signed(least, units), signed(greatest, units), units));
    setText(this.rms_, t('RMS {0}', figure(inUnit(survey.rms_mm, units))));
    this.plot_.show(quantiles, toleranceMm, rangeOf(survey, toleranceMm), units);
    const beyond = survey.worst.filter(({ mm }) => Math.abs(mm) > toleranceMm);
    this.places.hidden = beyond.length === 0;
    this.worst_.replaceChildren(
      ...beyond.map((place) => {
        const text = signed(place.mm, units);
        const press = button(text, t('Show this spot'), () => this.actions.place(place));
        press.classList.add(place.mm < 0 ? 'too-deep' : 'left-over');
        return h('li', {}, press);
      }),
    );
  }

  private makeFound_(): HTMLElement {
    return h(
      'div',
      { class: 'deviation-found', hidden: '' },
      h('label', { class: 'inspect-row' }, t('Tolerance ±'), this.tolerance_, this.unit_),
      h('p', { class: 'inspect-figures' }, this.within_, this.span_, this.rms_),
      this.plot_.element,
      this.places,
    );
  }

  private listenToDrops_(): void {
    const { element } = this;
    element.addEventListener('dragover', (event) => {
      if (this.add_.hidden || !event.dataTransfer?.types.includes('Files')) return;
      event.preventDefault();
      element.classList.add('dropping');
    });
    for (const end of ['dragleave', 'drop'])
      element.addEventListener(end, () => element.classList.remove('dropping'));
    element.addEventListener('drop', (event) => {
      const file = event.dataTransfer?.files[0];
      if (this.add_.hidden || !file) return;
      event.preventDefault();
      this.actions.added(file);
    });
  }
}
