// SPDX-License-Identifier: Apache-2.0
// The panel of NC programs: upload, list, control, text with the live line, alarms.

import { t } from '../../strings';
import '../style/programs.css';
import { ServerError } from '../../link/server_error';
import { isOpen } from '../../model/programs';
import type { SessionModel } from '../../model/session';
import type { ProgramInfo, Vec3 } from '../../wire/types';
import { h, setText } from '../dom';
import { count, figure, sentence, volume } from '../format';
import type { ProgramPlace } from '../../model/program_place';
import { OneOpen } from '../one_open';
import { AlarmList } from './alarm_list';
import { Controls } from './controls';
import { CutControl } from './cut_control';
import { ProgramList } from './program_list';
import { PathControl } from './path_control';
import type { PathHost } from './path_control';
import { isOutdated, ProgramRequests } from './requests';
import type { ProgramDetails } from './requests';
import { TargetChoice } from './target_choice';
import { duration, watchText } from './texts';
import { TextView } from './text_view';
import { Upload } from './upload';

const UPDATE_MS = 100;
const ASK_EVERY_MS = 1000; // for the details of a program that moves

export class ProgramsPanel {
  private readonly requests_: ProgramRequests;
  private readonly upload_: Upload;
  private readonly target_: TargetChoice;
  private readonly controls_: Controls;
  private readonly text_: TextView;
  private readonly list_ = new ProgramList((id) => this.press_(id));
  private readonly note_ = h('p', { class: 'program-note', role: 'status' });
  private readonly figures_ = h('p', { class: 'quiet program-figures' });
  private readonly progress_ = h('progress', { max: '1', 'aria-label': t('Progress') });
  private readonly alarms_ = new AlarmList(({ fromLine, place }) => {
    this.text_.mark({ line: fromLine, word: '' });
    this.path_?.markLine(fromLine, place);
    this.path_?.lookAt(place);
  });
  private readonly path_: PathControl | null;
  private readonly cut_: CutControl;
  private readonly follow_ = h(
    'button',
    { type: 'button', class: 'button quiet-button program-follow', hidden: '' },
    t('Show current line'),
  );
  private readonly close_ = (): void => this.toggle();
  private readonly one_: HTMLElement;
  private readonly element_: HTMLElement;
  private timer_: ReturnType<typeof setInterval> | undefined;
  private drawn_ = -1;
  private selected_: number | null = null;
  /** A file that was rejected is shown, which no program replaces unless the user selects it. */
  private showsRejected_ = false;
  /** The program whose text is shown; null: none, or one that was rejected. */
  private textOf_: number | null = null;
  private details_ = new Map<number, ProgramDetails>();
  private asking_ = false;
  private askedMs_ = -Infinity;
  /** The line that is to be shown once its program and its text are there. */
  private wanted_: ProgramPlace | null = null;

  constructor(
    private readonly model: SessionModel,
    session: string,
    private readonly opener: HTMLElement,
    pathHost: PathHost | null = null,
    private readonly oneOpen = new OneOpen(),
    private readonly layoutChanged: () => void = () => undefined,
  ) {
    this.requests_ = new ProgramRequests(session);
    this.path_ = pathHost && new PathControl(pathHost, (id) => this.requests_.path(id));
    this.cut_ = new CutControl(
      (participant) => this.requests_.cut(participant),
      (timeS) => this.markTime_(timeS),
      () => this.path_?.feeds ?? null,
    );
    this.text_ = new TextView(
      (follows) => (this.follow_.hidden = follows),
      (line) => this.markPlace_(line),
    );
    if (this.path_)
      this.path_.pressed = (line) => this.text_.mark({ line, word: '', isPlace: true });
    this.controls_ = new Controls({
      change: (query) => this.order_((id) => this.requests_.change(id, query)),
      cancel: () => this.order_((id) => this.requests_.cancel(id)),
    });
    const close = h('button', { type: 'button', class: 'button quiet-button' }, t('Close'));
    this.one_ = h(
      'div',
      { class: 'program-one', hidden: '' },
      this.controls_.element,
      this.progress_,
      this.figures_,
      ...(this.path_ ? [this.path_.element] : []),
      this.cut_.element,
      this.alarms_.element,
    );
    this.element_ = h(
      'section',
      { class: 'programs', 'aria-label': t('NC programs'), hidden: '' },
      h('header', {}, h('h2', {}, t('NC programs')), close),
    );
    this.target_ = new TargetChoice(session);
    this.upload_ = new Upload(this.element_, this.target_, {
      chosen: (file, query) => void this.send_(file, query),
    });
    this.element_.append(
      this.upload_.element,
      this.note_,
      this.list_.element,
      this.one_,
      this.text_.element,
      this.follow_,
    );
    close.addEventListener('click', () => this.toggle());
    this.follow_.addEventListener('click', () => this.text_.follow(true));
    (opener.closest('main') ?? document.body).append(this.element_);
  }

  toggle(): void {
    const open = this.element_.hidden;
    this.element_.hidden = !open;
    this.opener.setAttribute('aria-expanded', String(open));
    if (open) this.oneOpen.opens(this.close_);
    else this.oneOpen.closed(this.close_);
    this.path_?.setOpen(open);
    this.layoutChanged();
    clearInterval(this.timer_);
    if (!open) return;
    this.timer_ = setInterval(() => this.update_(), UPDATE_MS);
    void this.load_();
    this.drawn_ = -1;
    this.update_();
  }

  /** Shows a line of a program, and the place that it cut. Takes effect when the panel is open. */
  showLine(place: ProgramPlace): void {
    this.wanted_ = place;
    this.drawn_ = -1;
    if (!this.element_.hidden) this.update_();
  }

  private showWanted_(): void {
    const { wanted_: wanted } = this;
    if (!wanted || !this.model.programs.get(wanted.program)) return;
    if (this.selected_ !== wanted.program) this.select_(wanted.program);
    if (this.textOf_ !== wanted.program) return;
    this.wanted_ = null;
    this.markPlace_(wanted.line, wanted.place);
    this.text_.element.scrollIntoView({ block: 'nearest' });
    this.path_?.lookAt(wanted.place);
  }

  private may_(what: 'run_programs' | 'download'): boolean {
    const may = this.model.welcome?.may;
    return may === undefined || may.includes(what);
  }

  private update_(): void {
    const { programs } = this.model;
    if (programs.incomplete) {
      programs.incomplete = false;
      void this.load_();
    }
    this.upload_.element.hidden = !this.may_('run_programs');
    if (programs.changes !== this.drawn_) this.draw_();
    const program = this.program_;
    if (program && this.may_('download')) this.cut_.update(program, performance.now());
    if (program && isOutdated(this.details_.get(program.id), program)) void this.ask_(program.id);
  }

  private get program_(): ProgramInfo | undefined {
    return this.selected_ === null ? undefined : this.model.programs.get(this.selected_);
  }

  private draw_(): void {
    const { programs } = this.model;
    this.drawn_ = programs.changes;
    this.showWanted_();
    const all = programs.all();
    if (!this.program_ && !this.showsRejected_) this.select_(all[0]?.id ?? null);
    this.list_.update(all, this.selected_);
    const program = this.program_;
    this.one_.hidden = program === undefined;
    if (program) this.show_(program);
  }

  private press_(id: number): void {
    this.select_(id);
    this.drawn_ = -1;
    this.update_();
  }

  private show_(program: ProgramInfo): void {
    const done = program.motions === 0 ? 1 : program.motions_done / program.motions;
    this.progress_.value = done;
    const details = this.details_.get(program.id);
    this.controls_.update(program, this.may_('run_programs') && details?.mayControl !== false);
    const removed = volume(program.removed_volume_mm3).join(' ');
    const tools = details && details.tools.length > 1 ? t(' of {0}', details.tools.join(', ')) : '';
    const lines = [
      t('{0} of {1} at feed rate, ', duration(program.elapsed_s), duration(program.programmed_s)) +
        t('line {0}, tool {1}{2}, ', count(program.line), program.tool, tools) +
        t('feed {0} mm/min, {1} removed.', figure(program.feed_mm_per_min), removed),
      ...(details?.readAs ? [t('Read as {0}.', details.readAs)] : []),
      ...(details?.target ? [watchText(details)] : []),
      ...(details?.warnings ?? []).slice(0, 3),
    ];
    setText(this.figures_, lines.join(' '));
    if (this.textOf_ === program.id) this.text_.setLive(isOpen(program) ? program.line : 0);
    if (details) this.alarms_.update(details.alarms);
    this.path_?.update(program);
  }

  /** Marks a line of the text, and its place in the picture. */
  private markPlace_(line: number, place?: Vec3): void {
    if (this.textOf_ === null) return;
    this.text_.mark({ line, word: '', isPlace: true });
    this.path_?.markLine(line, place);
  }

  /** Marks the line that is carved at a time of the program, and its place; returns the line. */
  private markTime_(timeS: number): number | null {
    const line = this.path_?.markTime(timeS) ?? null;
    if (line !== null && this.textOf_ !== null) this.text_.mark({ line, word: '', isPlace: true });
    return line;
  }

  private select_(id: number | null): void {
    if (id === this.selected_ && this.textOf_ === id) return;
    this.selected_ = id;
    this.showsRejected_ = false;
    this.textOf_ = null;
    this.alarms_.update([]);
    this.path_?.select(id);
    this.cut_.select(id);
    this.text_.show('');
    if (id === null) return;
    this.requests_.source(id).then(
      (text) => {
        if (this.selected_ !== id) return;
        this.textOf_ = id;
        this.text_.show(text);
        this.text_.follow(true);
        this.drawn_ = -1;
      },
      (problem: unknown) => {
        this.wanted_ = null;
        this.tell_(problem);
      },
    );
  }

  /** Everything about the programs, also about those that ended long ago. */
  private async load_(): Promise<void> {
    try {
      const targets = this.target_.update(this.model.welcome?.pitch_mm);
      const list = await this.requests_.list();
      for (const details of list) this.details_.set(details.program.id, details);
      this.model.programs.add(list.map(({ program }) => program));
      await targets;
    } catch (problem) {
      this.tell_(problem);
    }
  }

  private async ask_(id: number): Promise<void> {
    const nowMs = performance.now();
    if (this.asking_ || nowMs - this.askedMs_ < ASK_EVERY_MS) return;
    this.asking_ = true;
    this.askedMs_ = nowMs;
    try {
      this.keep_(await this.requests_.details(id));
    } catch (problem) {
      this.tell_(problem);
    }
    this.asking_ = false;
  }

  private keep_(details: ProgramDetails): void {
    this.details_.set(details.program.id, details);
    this.model.programs.add([details.program]);
  }

  private order_(order: (id: number) => Promise<ProgramDetails>): void {
    if (this.selected_ === null) return;
    setText(this.note_, '');
    order(this.selected_).then(
      (details) => this.keep_(details),
      (problem: unknown) => this.tell_(problem),
    );
  }

  private async send_(file: File, query: string): Promise<void> {
    this.note_.classList.remove('bad');
    setText(this.note_, t('Uploading {0}…', file.name));
    try {
      const details = await this.requests_.upload(file, query);
      setText(this.note_, '');
      this.keep_(details);
      this.select_(details.program.id);
    } catch (problem) {
      this.tell_(problem);
      if (!(problem instanceof ServerError) || problem.line === 0) return;
      this.showRejected_(await file.text(), problem);
    }
  }

  private showRejected_(text: string, problem: ServerError): void {
    this.select_(null);
    this.showsRejected_ = true;
    this.text_.show(text);
    this.text_.mark(problem);
    this.drawn_ = -1;
  }

  private tell_(problem: unknown): void {
    this.note_.classList.add('bad');
    setText(this.note_, sentence((problem as Error).message));
  }
}
