// SPDX-License-Identifier: Apache-2.0
// The panel of NC programs: upload, list, control, text with the live line, alarms.

import { batch, effect, signal, untracked } from '@preact/signals';
import type { VNode } from 'preact';
import { t } from '../../strings';
import '../style/programs.css';
import { ServerError } from '../../link/server_error';
import type { ProgramPlace } from '../../model/program_place';
import { isOpen } from '../../model/programs';
import { stockBounds } from '../../model/session';
import type { SessionModel } from '../../model/session';
import type { ProgramInfo, Vec3 } from '../../wire/types';
import { sentence } from '../format';
import { CutControl } from './cut_control';
import type { ProgramsPanelHost } from './host';
import { PanelView } from './panel_view';
import { PathControl } from './path_control';
import { isOutdated, ProgramRequests } from './requests';
import type { Alarm, ProgramDetails } from './requests';
import { ProgramsState } from './state';
import { TargetChoice } from './target_choice';
import { TextState } from './text_state';
import { RunOptions } from './upload';
import { WrenchControl } from './wrench_control';

const ASK_EVERY_MS = 1000; // for the details of a program that moves
const ARROW_SHARE = 0.12; // of the block's diagonal

/** The length of the longest arrow along a path. */
function arrowMm({ welcome }: SessionModel): number {
  if (!welcome) return 0;
  const { min, max } = stockBounds(welcome.stock);
  return ARROW_SHARE * Math.hypot(...max.map((value, k) => value - min[k]!));
}

export class ProgramsPanel {
  private readonly state_: ProgramsState;
  private readonly requests_: ProgramRequests;
  private readonly options_: RunOptions;
  private readonly text_ = new TextState();
  private readonly path_: PathControl | null;
  private readonly cut_: CutControl;
  private readonly wrench_: WrenchControl | null;
  private readonly close_ = (): void => this.toggle();
  private isAsking_ = false;
  private askedMs_ = -Infinity;
  /** The line to be shown once its program and its text are there. */
  private readonly wanted_ = signal<ProgramPlace | null>(null);

  constructor(private readonly host: ProgramsPanelHost) {
    const { model, session, path, shell } = host;
    this.state_ = new ProgramsState(model, shell.isProgramsOpen);
    this.requests_ = new ProgramRequests(session);
    this.options_ = new RunOptions(new TargetChoice(session));
    this.path_ = path ? new PathControl(path, (id) => this.requests_.path(id)) : null;
    this.cut_ = new CutControl(
      (participant) => this.requests_.cut(participant),
      (timeS) => this.markTime_(timeS),
      () => this.path_?.feeds ?? null,
      () => import('./cut_plot'),
    );
    this.wrench_ = path
      ? new WrenchControl(path.picture, this.state_.isOpen, this.cut_.peaks, () => arrowMm(model))
      : null;
    if (this.path_)
      this.path_.pressed = (line) => this.text_.markLine({ line, word: '', isPlace: true });
    effect(() => this.showOpen_());
    effect(() => this.loadMissing_());
    effect(() => this.selectFirst_());
    effect(() => this.showWanted_());
    effect(() => this.showProgress_());
    effect(() => this.askIfOutdated_());
  }

  toggle(): void {
    const { isOpen } = this.state_;
    isOpen.value = !isOpen.peek();
    if (isOpen.peek()) this.host.oneOpen?.opens(this.close_);
    else this.host.oneOpen?.closed(this.close_);
    if (isOpen.peek()) void this.load_();
  }

  /** Shows a line of a program, and the place that it cut. Takes effect when the panel is open. */
  showLine(place: ProgramPlace): void {
    this.wanted_.value = place;
  }

  view(): VNode {
    const actions = {
      close: () => this.toggle(),
      send: (files: FileList | null) => this.sendAll_(files),
      select: (id: number) => this.select_(id),
      change: (query: string) => this.order_((id) => this.requests_.change(id, query)),
      cancel: () => this.order_((id) => this.requests_.cancel(id)),
      replay: this.host.replay && ((program: ProgramInfo) => this.replay_(program)),
      showAlarm: (alarm: Alarm) => this.showAlarm_(alarm),
      pressLine: (line: number) => this.markPlace_(line),
    };
    return (
      <PanelView
        shell={this.host.shell}
        state={this.state_}
        options={this.options_}
        actions={actions}
        text={this.text_}
        cut={this.cut_}
        path={this.path_}
        wrench={this.wrench_}
      />
    );
  }

  /** Leaves the picture its place and shows the cuts of a program there. */
  private replay_(program: ProgramInfo): void {
    this.toggle();
    this.host.replay?.(program);
  }

  private showOpen_(): void {
    const isOpen = this.state_.isOpen.value;
    untracked(() => this.path_?.setOpen(isOpen));
  }

  private loadMissing_(): void {
    if (!this.state_.isOpen.value || !this.host.model.programs.incomplete) return;
    this.host.model.programs.requested();
    void this.load_();
  }

  private selectFirst_(): void {
    const { isOpen, program, showsRejected, programs } = this.state_;
    if (!isOpen.value || program || showsRejected.value) return;
    const id = programs[0]?.id ?? null;
    untracked(() => this.select_(id));
  }

  private showWanted_(): void {
    const { isOpen, selected, textOf } = this.state_;
    const wanted = this.wanted_.value;
    if (!isOpen.value || !wanted || !this.host.model.programs.get(wanted.program)) return;
    if (selected.value !== wanted.program) untracked(() => this.select_(wanted.program));
    if (textOf.value !== wanted.program) return;
    this.wanted_.value = null;
    this.markPlace_(wanted.line, wanted.place);
    this.text_.reveal();
    this.path_?.lookAt(wanted.place);
  }

  /** Shows in text, picture and plot how far the selected program has come. */
  private showProgress_(): void {
    const { isOpen: isPanelOpen, program, textOf } = this.state_;
    if (!isPanelOpen.value || !program) return;
    if (textOf.value === program.id) this.text_.setLive(isOpen(program) ? program.line : 0);
    this.path_?.update(program);
    if (this.state_.may('download')) this.cut_.update(program);
  }

  private showAlarm_({ fromLine, place }: Alarm): void {
    this.text_.markLine({ line: fromLine, word: '' });
    this.path_?.markLine(fromLine, place);
    this.path_?.lookAt(place);
  }

  /** Marks a line of the text, and its place in the picture. */
  private markPlace_(line: number, place?: Vec3): void {
    if (this.state_.textOf.peek() === null) return;
    this.text_.markLine({ line, word: '', isPlace: true });
    this.path_?.markLine(line, place);
  }

  /** Marks the line that is carved at a time of the program, and its place. Returns the line. */
  private markTime_(timeS: number): number | null {
    const line = this.path_?.markTime(timeS) ?? null;
    if (line !== null && this.state_.textOf.peek() !== null)
      this.text_.markLine({ line, word: '', isPlace: true });
    return line;
  }

  private select_(id: number | null): void {
    const { selected, textOf, showsRejected } = this.state_;
    if (id === selected.peek() && textOf.peek() === id) return;
    this.path_?.select(id);
    this.cut_.select(id);
    this.text_.show('');
    batch(() => {
      selected.value = id;
      showsRejected.value = false;
      textOf.value = null;
    });
    if (id === null) return;
    this.requests_.source(id).then(
      (text) => {
        if (selected.peek() !== id) return;
        this.text_.show(text);
        this.text_.follow(true);
        textOf.value = id;
      },
      (problem: unknown) => {
        this.wanted_.value = null;
        this.tell_(problem);
      },
    );
  }

  /** Loads all programs, also those that ended long ago, and the parts to compare with. */
  private async load_(): Promise<void> {
    try {
      const targets = this.options_.target.update(this.host.model.welcome?.pitch_mm);
      this.state_.keep(await this.requests_.list());
      await targets;
    } catch (problem) {
      this.tell_(problem);
    }
  }

  /** Requests the details of the selected program if they are outdated, and soon again after that. */
  private askIfOutdated_(): void {
    const { isOpen, program, details } = this.state_;
    if (!isOpen.value || !program || !isOutdated(details, program) || this.isAsking_) return;
    this.isAsking_ = true;
    const delayMs = Math.max(0, this.askedMs_ + ASK_EVERY_MS - performance.now());
    if (delayMs === 0) void this.ask_();
    else setTimeout(() => void this.ask_(), delayMs);
  }

  private async ask_(): Promise<void> {
    const id = this.state_.isOpen.peek() ? this.state_.selected.peek() : null;
    try {
      if (id !== null) this.askedMs_ = performance.now();
      if (id !== null) this.state_.keep([await this.requests_.details(id)]);
    } catch (problem) {
      this.tell_(problem);
    }
    this.isAsking_ = false;
    untracked(() => this.askIfOutdated_());
  }

  private order_(order: (id: number) => Promise<ProgramDetails>): void {
    const id = this.state_.selected.peek();
    if (id === null) return;
    this.say_('', this.state_.note.peek().isBad);
    order(id).then(
      (details) => this.state_.keep([details]),
      (problem: unknown) => this.tell_(problem),
    );
  }

  private sendAll_(files: FileList | null): void {
    for (const file of files ?? []) void this.send_(file, this.options_.query);
  }

  private async send_(file: File, query: string): Promise<void> {
    this.say_(t('Uploading {0}…', file.name));
    try {
      const details = await this.requests_.upload(file, query);
      this.say_('');
      this.state_.keep([details]);
      this.select_(details.program.id);
    } catch (problem) {
      this.tell_(problem);
      if (!(problem instanceof ServerError) || problem.line === 0) return;
      this.showRejected_(await file.text(), problem);
    }
  }

  private showRejected_(text: string, problem: ServerError): void {
    batch(() => {
      this.select_(null);
      this.state_.showsRejected.value = true;
    });
    this.text_.show(text);
    this.text_.markLine(problem);
  }

  private say_(text: string, isBad = false): void {
    this.state_.note.value = { text, isBad };
  }

  private tell_(problem: unknown): void {
    this.say_(sentence((problem as Error).message), true);
  }
}
