// SPDX-License-Identifier: Apache-2.0
// The side panel of the page without a server: files, how far the program is, its text, figures,
// downloads.

import { t } from '../strings';
import '../ui/style/programs.css';
import type { StockMaterialPreset } from '../model/materials';
import { capMouse } from '../carve/devices/cap_mouse';
import type { CapMouseHost } from '../carve/devices/cap_mouse';
import { h, setText } from '../ui/dom';
import { details, Figure, section } from '../ui/figures';
import { count, figure, volume } from '../ui/format';
import { languageChoice } from '../ui/language_choice';
import { nameField } from './name_field';
import { MaterialChoice } from '../ui/material_choice';
import { duration } from '../ui/programs/texts';
import { TextView } from '../ui/programs/text_view';
import { Transport } from '../ui/timeline/transport';
import type { About, GivenFiles, Progress, TakeHomeFormat } from './program_block';

export type Status = 'empty' | 'reading' | 'carving' | 'rest' | 'failed';

export interface SideActions {
  choose: () => void;
  remove: (what: 'program' | 'scene' | 'stock' | 'journal') => void;
  /** Stops the worker. */
  stop: () => void;
  seek: (motion: number) => void;
  /** Plays on with a rate, or rests with 0. */
  play: (rate: number) => void;
  takeHome: (format: TakeHomeFormat) => void;
  save: () => void;
  linePressed: (line: number) => void;
  materialChosen: (preset: StockMaterialPreset) => void;
  /** The camera that a 3D mouse moves. */
  capMouse: CapMouseHost;
  layoutChanged: () => void;
}

function button(text: string, action: () => void): HTMLButtonElement {
  const element = h('button', { type: 'button', class: 'history-button' }, text);
  element.addEventListener('click', action);
  return element;
}

/** Whether `motions` counts the records of a journal: motions, undo and others. */
function isJournal({ kernel_version }: About): boolean {
  return kernel_version !== undefined;
}

export class SidePanel {
  private readonly handle_ = h(
    'button',
    { type: 'button', class: 'sheet-handle', 'aria-expanded': 'false' },
    t('Show more'),
  );
  private readonly files_ = h('ul', { class: 'given-files' });
  private readonly error_ = h('p', { class: 'program-note bad', role: 'alert' });
  private readonly bar_ = h('progress', { max: '1', 'aria-label': t('Progress') });
  private readonly stop_: HTMLButtonElement;
  private readonly scrub_ = h('input', {
    type: 'range',
    min: '0',
    step: '1',
    class: 'scrub',
    'aria-label': t('Position in the program'),
  });
  private readonly stored_ = h('p', { class: 'quiet program-figures', role: 'status' });
  private readonly transport_: Transport;
  private carved_ = 0;
  private readonly where_ = h('p', { class: 'quiet program-figures' });
  private readonly text_: TextView;
  private readonly motions_ = new Figure(t('Motions'));
  private readonly removed_ = new Figure(t('Removed'));
  private readonly triangles_ = new Figure(t('Triangles'));
  private readonly pitch_ = new Figure(t('Grid spacing'));
  private readonly notes_ = h('ul', { class: 'given-notes quiet' });
  private readonly hash_ = h('code', {
    title: t('State hash: kerf-carve prints the same one for the same files'),
    'data-settled': t('complete'),
  });
  private readonly took_ = h('p', { class: 'quiet program-figures' });
  private readonly takeHome_: HTMLButtonElement[];
  private readonly save_: HTMLButtonElement;
  private readonly name_ = nameField();
  /** For the path of the program in the picture. */
  readonly path = h('div');
  private readonly program_: HTMLElement;
  private readonly assumed_: HTMLElement;
  readonly element: HTMLElement;
  private about_: About | null = null;

  constructor(private readonly actions: SideActions) {
    this.stop_ = button(t('Stop'), actions.stop);
    this.scrub_.addEventListener('input', () => actions.seek(Number(this.scrub_.value)));
    this.transport_ = new Transport({
      step: (steps) => {
        const end = this.about_?.motions ?? 0;
        actions.seek(Math.max(0, Math.min(end, this.carved_ + steps)));
      },
      play: (rate) => actions.play(rate),
    });
    this.text_ = new TextView(() => undefined, actions.linePressed);
    this.takeHome_ = (['stl', '3mf'] as const).map((format) =>
      button(format.toUpperCase(), () => actions.takeHome(format)),
    );
    this.save_ = button('KERF', actions.save);
    this.save_.title = t('Saves the block with all strokes, to open here or in kerf-server');
    this.program_ = section(
      t('Program'),
      h('div', { class: 'program-one' }, this.bar_),
      h('div', { class: 'scrub-row' }, this.scrub_, this.stop_),
      this.transport_.element,
      this.where_,
      this.path,
      this.text_.element,
    );
    this.assumed_ = section(t('Notes'), this.notes_);
    const figures = [this.motions_, this.triangles_, this.pitch_].map(({ element }) => element);
    this.element = h(
      'aside',
      { class: 'panel', 'aria-label': t('Details') },
      this.handle_,
      h(
        'div',
        { class: 'panel-scroll' },
        section(t('Files'), this.files_, button(t('Choose files…'), actions.choose), this.error_),
        this.program_,
        h('dl', { class: 'figures' }, this.removed_.element),
        section(
          t('Downloads'),
          h('div', { class: 'history-actions' }, ...this.takeHome_, this.save_),
          this.name_,
        ),
        this.assumed_,
        section(t('Material'), new MaterialChoice(actions.materialChosen).element),
        this.stored_,
        details(
          h('dl', { class: 'figures' }, ...figures),
          h('p', { class: 'quiet hash' }, t('State hash '), this.hash_),
          this.took_,
        ),
        h('div', { class: 'preferences' }, languageChoice(), capMouse(actions.capMouse) ?? ''),
      ),
    );
    this.handle_.addEventListener('click', () => this.toggle_());
    new ResizeObserver(() => actions.layoutChanged()).observe(this.element);
    this.setStatus('empty');
  }

  /** The files that are there; `text` is that of the program. */
  setFiles(files: GivenFiles, text: string | null): void {
    const { actions } = this;
    const row = (what: 'program' | 'scene' | 'stock' | 'journal', label: string): HTMLElement[] => {
      const file = files[what];
      if (!file) return [];
      const remove = h(
        'button',
        { type: 'button', class: 'quiet-action', 'aria-label': t('Remove {0}', file.name) },
        t('Remove'),
      );
      remove.addEventListener('click', () => actions.remove(what));
      return [h('li', {}, h('span', {}, file.name), h('small', { class: 'quiet' }, label), remove)];
    };
    const others = files.others.map(({ name }) =>
      h('li', {}, h('span', {}, name), h('small', { class: 'quiet' }, t('subroutine'))),
    );
    this.files_.replaceChildren(
      ...row('journal', t('KERF file')),
      ...row('program', t('program')),
      ...row('scene', t('scene')),
      ...row('stock', t('stock')),
      ...others,
    );
    this.about_ = null;
    this.assumed_.hidden = true;
    for (const one of [this.motions_, this.removed_, this.triangles_, this.pitch_]) one.set('–');
    this.program_.hidden = text === null && files.journal === null;
    setText(this.program_.querySelector('h2')!, text === null ? t('History') : t('Program'));
    this.text_.element.hidden = text === null;
    this.text_.show(text ?? '');
    this.text_.follow(true);
    this.showError('', null);
    this.setHash(null, 0);
    this.setStored('');
  }

  setStatus(status: Status): void {
    const isBusy = status === 'reading' || status === 'carving';
    this.stop_.hidden = !isBusy;
    this.bar_.hidden = !isBusy;
    if (status === 'reading') {
      this.bar_.removeAttribute('value');
      setText(this.where_, t('Reading…'));
    } else if (status === 'failed') setText(this.where_, '');
    this.scrub_.disabled = this.about_ === null;
    for (const one of [...this.takeHome_, this.save_])
      one.disabled = status !== 'rest' || this.about_ === null;
  }

  setAbout(about: About): void {
    this.about_ = about;
    this.scrub_.max = String(about.motions);
    this.motions_.label = isJournal(about) ? t('Steps') : t('Motions');
    this.motions_.set(count(about.motions));
    this.pitch_.set(figure(about.pitch_mm), 'mm');
    const lines = [...about.notes, ...about.warnings];
    this.notes_.replaceChildren(...lines.map((line) => h('li', {}, line)));
    this.assumed_.hidden = lines.length === 0;
  }

  /** `follows`: the scrub bar moves with the program, which the user does not move now. */
  setProgress(progress: Progress, triangles: number, follows: boolean): void {
    const about = this.about_;
    if (!about) return;
    const { carved, line } = progress;
    this.carved_ = carved;
    this.bar_.value = about.motions > 0 ? carved / about.motions : 1;
    if (follows) this.scrub_.value = String(carved);
    this.removed_.set(...volume(progress.removed_mm3));
    this.triangles_.set(count(triangles));
    const [at, end] = [count(carved), count(about.motions)];
    const where = t('Step {0} of {1}', at, end);
    const time = `${duration(progress.machining_s)} / ${duration(about.machining_s)}`;
    const place = line > 0 ? t('{0}, line {1}, {2}', where, count(line), time) : where;
    setText(this.where_, place);
    this.scrub_.setAttribute('aria-valuetext', place);
    this.text_.setLive(carved < about.motions ? line : 0);
  }

  /** Whether the block has a journal, which the page may save. */
  setJournal(isThere: boolean): void {
    this.save_.hidden = this.name_.hidden = !isThere;
    if (!isThere) return;
    this.program_.hidden = false;
    setText(this.program_.querySelector('h2')!, t('History'));
  }

  /** @param rate with which the block plays; 0: it does not */
  setRate(rate: number): void {
    this.transport_.update(rate, false);
  }

  /** Shows how the state compares with the one that the journal stores. */
  setStored(text: string): void {
    setText(this.stored_, text);
  }

  setHash(hash: string | null, carvingMs: number): void {
    setText(this.hash_, hash ?? '–');
    this.hash_.classList.toggle('settled', hash !== null);
    const seconds = figure(carvingMs / 1000);
    setText(this.took_, hash === null ? '' : t('Carved in {0} s in this browser.', seconds));
  }

  /** Shows why files are of no use, and marks the place in the program. */
  showError(reason: string, place: { line: number; word: string } | null): void {
    setText(this.error_, reason);
    if (place) this.text_.mark(place);
  }

  markLine(line: number): void {
    this.text_.mark({ line, word: '', isPlace: true });
  }

  private toggle_(): void {
    const open = this.element.classList.toggle('open');
    this.handle_.setAttribute('aria-expanded', String(open));
    this.handle_.textContent = open ? t('Show less') : t('Show more');
  }
}
