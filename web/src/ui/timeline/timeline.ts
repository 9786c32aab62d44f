// SPDX-License-Identifier: Apache-2.0
// The timeline: the journal of the session as a strip, on which the picture can be taken to any
// motion of the past and back to the present.

import { t } from '../../strings';
import '../style/timeline.css';
import { branch, deleteVersion, nameVersion, renameVersion } from '../../link/history';
import { pageAddress } from '../../link/request';
import { changeStroke } from '../../link/strokes';
import type { Stroke, StrokeChange } from '../../model/stroke';
import { PartPlayback } from '../../model/part_playback';
import { Seeker } from '../../model/seeker';
import { whyNotUndo } from '../../model/stroke_choice';
import { strokeAt } from '../../model/timeline';
import { toolName } from '../../model/tool_profile';
import { Authors } from '../authors';
import { h, setText } from '../dom';
import { count, sentence } from '../format';
import { changedText } from '../history';
import { Banner } from './banner';
import { Compare } from './compare';
import type { TimelineHost } from './host';
import { Records } from './records';
import { CLOCK, Selection } from './selection';
import { Strip } from './strip';
import { Transport } from './transport';
import { versionControls } from './versions';

const UPDATE_MS = 50;

const KEYS: Record<string, number> = {
  ArrowLeft: -1,
  ArrowRight: 1,
  PageUp: 1000,
  PageDown: -1000,
};

export class Timeline {
  private readonly seeker_: Seeker;
  private readonly authors_: Authors;
  private readonly records_: Records;
  private readonly banner_ = new Banner(() => this.seek_('live', 0));
  private readonly selection_ = new Selection(
    (change, stroke) => void this.change_(change, stroke),
  );
  private readonly strip_ = new Strip({
    scrubbed: (record) => this.scrub_(record),
    selected: (stroke) => this.select_(stroke),
    pressed: (event) => this.key_(event),
  });
  private readonly transport_ = new Transport({
    step: (motions) => this.step_(motions),
    play: (rate) => this.play_(rate),
    live: () => this.seek_('live', 0),
  });
  private readonly compare_: Compare;
  private readonly where_ = h('p', { class: 'timeline-where' });
  private readonly element_: HTMLElement;
  private selected_: Stroke | null = null;
  /** The participant whose strokes are played as soon as they are known. */
  private toPlay_: number | null = null;
  private part_: PartPlayback | null = null;
  private problems_: number;
  private shownAt_ = '';
  private timer_: ReturnType<typeof setInterval> | undefined;

  constructor(
    private readonly host: TimelineHost,
    private readonly opener: HTMLElement,
  ) {
    const { model, session } = host;
    this.problems_ = model.problems;
    this.seeker_ = new Seeker(host.seek);
    this.authors_ = new Authors(model, session);
    this.records_ = new Records(
      session,
      () => this.redraw_(),
      (problem) => this.tell_(problem),
    );
    const versions = versionControls({
      model,
      records: this.records_,
      actions: {
        go: (record) => this.seek_(record, 0),
        name: (name) =>
          void this.keep_(nameVersion(session, name, this.record_), t('“{0}” was saved.', name)),
        rename: (old, name) =>
          void this.keep_(
            renameVersion(session, old, name),
            t('“{0}” was renamed “{1}”.', old, name),
          ),
        remove: (name) =>
          void this.keep_(deleteVersion(session, name), t('“{0}” was deleted.', name)),
        branch: (id) => void this.branch_(id),
      },
      proposed: () => `${session.slice(0, 50)}-${this.record_ ?? this.records_.end}`,
    });
    const main = opener.closest('main') ?? document.body;
    this.compare_ = new Compare(host.picture, main);
    versions.append(this.compare_.button);
    this.element_ = h(
      'section',
      { class: 'timeline', 'aria-label': t('Timeline'), hidden: '' },
      h('div', { class: 'timeline-controls' }, this.transport_.element, this.where_),
      this.strip_.element,
      h('div', { class: 'timeline-foot' }, this.selection_.element, versions),
    );
    main.append(this.banner_.element, this.element_);
    new ResizeObserver(() => {
      main.style.setProperty('--timeline', `${this.element_.offsetHeight}px`);
      host.layoutChanged();
    }).observe(this.element_);
  }

  /** Opens or closes it. The picture stays where it is in time. */
  toggle(): void {
    const open = this.element_.hidden;
    this.element_.hidden = !open;
    this.opener.setAttribute('aria-expanded', String(open));
    this.element_.parentElement?.classList.toggle('has-timeline', open);
    this.host.layoutChanged();
    if (open) {
      this.timer_ ??= setInterval(() => this.update_(), UPDATE_MS);
      this.records_.invalidate();
      void this.authors_.load().then(() => this.redraw_());
      this.update_();
      this.strip_.slider.focus();
    } else {
      this.compare_.end();
      this.opener.focus();
    }
  }

  /**
   * Plays the strokes of a participant from the first to the last, then shows the present. Takes
   * effect when the timeline is open.
   */
  playStrokesOf(participant: number): void {
    this.toPlay_ = participant;
    this.records_.invalidate();
  }

  /** Ends the playing of strokes. The picture stays where it is in time. */
  stopPlaying(): void {
    this.toPlay_ = null;
    this.part_ = null;
  }

  private beginPart_(): void {
    const row = this.records_.rows.find(({ participant }) => participant === this.toPlay_);
    const first = row?.strokes[0]?.id;
    if (!row || first === undefined) return;
    this.toPlay_ = null;
    const last = Math.max(...row.strokes.map((stroke) => stroke.last));
    this.part_ = new PartPlayback(first, last, performance.now());
  }

  private playPart_(nowMs: number): void {
    if (!this.part_) return;
    const record = this.part_.recordAt(nowMs);
    if (this.part_.isOver(nowMs)) this.seek_('live', 0);
    else if (record !== this.record_) this.ask_(record, 0);
  }

  /** The record that is shown, or about to be; null: the present. */
  private get record_(): number | null {
    const { wish } = this.seeker_;
    if (wish?.at === 'live') return null;
    if (typeof wish?.at === 'number') return wish.at;
    return this.host.model.state?.at?.record ?? null;
  }

  private seek_(at: number | 'live' | 'here', rate: number): void {
    this.stopPlaying();
    this.ask_(at, rate);
  }

  private ask_(at: number | 'live' | 'here', rate: number): void {
    this.selection_.note('');
    this.seeker_.ask({ at, rate }, this.host.model.state, performance.now());
    this.place_();
  }

  private scrub_(record: number): void {
    if (record === this.record_) return;
    // The right edge is the present, unless it is that of a part of the journal.
    const isEnd = record >= this.records_.end && !this.strip_.isZoomed;
    if (isEnd && !this.seeker_.looksBack) return;
    this.seek_(isEnd ? 'live' : record, 0);
  }

  private step_(motions: number): void {
    const { end } = this.records_;
    const to = (this.record_ ?? end) + motions;
    if (to > end && !this.seeker_.looksBack) return;
    this.seek_(Math.min(end, Math.max(0, to)), 0);
  }

  /** Plays on from where the picture is; from the present, all from the beginning. */
  private play_(rate: number): void {
    if (this.seeker_.looksBack) this.seek_('here', rate);
    else if (rate > 0) this.seek_(0, rate);
  }

  private key_(event: KeyboardEvent): boolean {
    const { key, shiftKey } = event;
    const motions = KEYS[key];
    if (motions !== undefined) this.step_(shiftKey ? motions * 100 : motions);
    else if (key === 'Home') this.seek_(0, 0);
    else if (key === 'End') this.seek_('live', 0);
    else if (key === ' ') this.transport_.toggle();
    else return false;
    return true;
  }

  private select_(stroke: Stroke | null): void {
    this.selected_ = stroke;
    this.strip_.select(stroke);
    const { model } = this.host;
    const why = model.welcome ? whyNotUndo(model.welcome) : '';
    const author = stroke ? this.authors_.nameOf(stroke.participant) : '';
    const tool = stroke ? toolName(model.tool(stroke.tool)) : '';
    this.selection_.show(stroke, author, tool, why);
  }

  private update_(): void {
    const { model } = this.host;
    const nowMs = performance.now();
    if (model.problems !== this.problems_ && this.seeker_.wish) {
      this.seeker_.rejected();
      this.stopPlaying();
      this.tell_(new Error(model.problem));
    }
    this.problems_ = model.problems;
    if (model.status === 'connected') this.seeker_.tick(model.state, nowMs);
    else this.seeker_.lost();
    this.playPart_(nowMs);
    this.place_();
    if (this.element_.hidden) {
      this.rest_();
      return;
    }
    const mayReadForces = model.welcome?.may?.includes('download') ?? true;
    this.records_.tick(nowMs, model.state, mayReadForces);
  }

  /** Nothing to do while the timeline is closed and the present is shown. */
  private rest_(): void {
    if (this.seeker_.looksBack) return;
    clearInterval(this.timer_);
    this.timer_ = undefined;
  }

  /** Shows where the picture is in time. */
  private place_(): void {
    const { state, participants } = this.host.model;
    const { wish } = this.seeker_;
    participants.looksBack = this.seeker_.looksBack;
    const record = this.record_;
    const isPast = this.seeker_.looksBack;
    const asked = wish && wish.at !== 'live' ? wish.rate : (state?.at?.rate ?? 0);
    const rate = this.part_ ? 1 : asked;
    const reached = record !== null && state?.at?.record === record ? state.at.time_ms : 0;
    const place = isPast ? this.describe_(record, reached) : '';
    const key = `${place} ${record} ${rate} ${this.records_.end} ${this.seeker_.wish !== null}`;
    if (key === this.shownAt_) return;
    this.shownAt_ = key;
    if (this.banner_.show(isPast ? place : null)) this.host.layoutChanged();
    this.transport_.update(isPast ? rate : 0, !isPast);
    this.compare_.show(isPast && record !== null ? t('Step {0}', count(record)) : t('Now'));
    setText(this.where_, isPast ? '' : t('{0} steps', count(this.records_.end)));
    this.strip_.place(record ?? this.records_.end, isPast ? place : t('live'), rate > 0 && !wish);
    if (
      asked > 0 &&
      !wish &&
      record !== null &&
      record >= this.records_.end &&
      this.records_.end > 0
    )
      this.seek_('live', 0);
  }

  /** “14:03:21 · record 4,711 of 20,000 · Ada” */
  private describe_(record: number | null, timeMs: number): string {
    if (record === null) return t('The past');
    const time = timeMs > 0 ? `${CLOCK.format(timeMs)} · ` : '';
    const { end, rows } = this.records_;
    const carving = rows
      .filter(({ strokes }) => strokeAt(strokes, record, 0) !== undefined)
      .map(({ participant }) => this.authors_.nameOf(participant));
    const place =
      end > 0 ? t('step {0} of {1}', count(record), count(end)) : t('step {0}', count(record));
    return [time + place, ...carving].join(' · ');
  }

  private redraw_(): void {
    this.beginPart_();
    const { rows, end, versions, forces } = this.records_;
    this.strip_.show({
      rows,
      end,
      versions,
      forces,
      colorOf: (participant) => this.authors_.colorOf(participant),
      nameOf: (participant) => this.authors_.nameOf(participant),
    });
    if (this.selected_) {
      const { id } = this.selected_;
      this.select_(this.records_.strokes.find((stroke) => stroke.id === id) ?? null);
    }
    this.shownAt_ = '';
    this.place_();
  }

  private async change_(change: StrokeChange, stroke: Stroke): Promise<void> {
    const name = this.authors_.nameOf(stroke.participant);
    await this.keep_(changeStroke(this.host.session, change, stroke.id), changedText(change, name));
  }

  private async branch_(id: string): Promise<void> {
    try {
      const made = await branch(this.host.session, this.record_, id);
      location.assign(pageAddress(`?session=${encodeURIComponent(made)}`));
    } catch (problem) {
      this.tell_(problem);
    }
  }

  private async keep_(order: Promise<void>, done: string): Promise<void> {
    try {
      await order;
      this.selection_.note(done);
      this.records_.invalidate();
    } catch (problem) {
      this.tell_(problem);
    }
  }

  private tell_(problem: unknown): void {
    this.selection_.note(sentence((problem as Error).message));
  }
}
