// SPDX-License-Identifier: Apache-2.0
// The timeline: the journal of the session as a strip, on which the picture can be taken to any
// motion of the past and back to the present.

import { batch, computed, effect, signal, untracked } from '@preact/signals';
import type { VNode } from 'preact';
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
import { count, sentence } from '../format';
import { changedText } from '../history/state';
import { Compare, CompareBorder } from './compare';
import type { TimelineHost } from './host';
import { Records } from './records';
import { CLOCK } from './selection';
import { Strip } from './strip';
import type { StripContent } from './strip_painter';
import { TimelineView } from './timeline_view';
import { Transport } from './transport';
import type { VersionsProps } from './versions';

const UPDATE_MS = 50;

const KEYS: Record<string, number> = {
  ArrowLeft: -1,
  ArrowRight: 1,
  PageUp: 1000,
  PageDown: -1000,
};

/** Where the picture is in time, as the timeline shows it. */
interface Place {
  /** The record that is shown, or about to be; null: the present. */
  record: number | null;
  isPast: boolean;
  /** The name of the place in the past; empty: the present. */
  name: string;
  rate: number;
  /** The server has not answered the last seek. */
  isAsked: boolean;
}

export class Timeline {
  private readonly seeker_: Seeker;
  private readonly authors_: Authors;
  private readonly records_: Records;
  private readonly strip_ = new Strip();
  private readonly transport_ = new Transport({
    step: (motions) => this.step_(motions),
    play: (rate) => this.play_(rate),
    live: () => this.seek_('live', 0),
  });
  private readonly compare_: Compare;
  private readonly versions_: VersionsProps;
  private readonly note_ = signal('');
  private readonly place_ = signal<Place>({
    ...{ record: null, isPast: false, name: '', rate: 0, isAsked: false },
  });
  private readonly content_ = computed((): StripContent => {
    const { rows, end, versions, forces } = this.records_;
    const authors = new Map(
      rows.map(({ participant }) => [
        participant,
        { name: this.authors_.nameOf(participant), color: this.authors_.colorOf(participant) },
      ]),
    );
    return { rows, end, versions, forces, authors };
  });
  /** The participant whose strokes are played as soon as they are known. */
  private toPlay_: number | null = null;
  private part_: PartPlayback | null = null;
  private problems_: number;
  private timer_: ReturnType<typeof setInterval> | undefined;

  constructor(private readonly host: TimelineHost) {
    const { model, session, shell } = host;
    this.problems_ = model.problems;
    this.seeker_ = new Seeker(host.seek);
    this.authors_ = new Authors(model, session);
    this.records_ = new Records(session, (problem) => this.tell_(problem));
    this.compare_ = new Compare(host.picture);
    this.versions_ = {
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
    };
    effect(() => {
      const isOpen = shell.isTimelineOpen.value;
      untracked(() => this.openChanged_(isOpen));
    });
    effect(() => {
      const { strokes } = this.records_;
      untracked(() => this.strokesCame_(strokes));
    });
  }

  /** Opens or closes it. The picture stays where it is in time. */
  toggle(): void {
    const { isTimelineOpen: isOpen } = this.host.shell;
    isOpen.value = !isOpen.peek();
    if (!isOpen.peek()) this.host.shell.focus('timeline');
  }

  border(): VNode {
    return <CompareBorder compare={this.compare_} />;
  }

  view(): VNode {
    const { host, records_: records, place_: place } = this;
    const { model } = host;
    const stroke = this.strip_.selected.value;
    const { record, isPast, name, rate, isAsked } = place.value;
    const { end } = records;
    return (
      <TimelineView
        shell={host.shell}
        back={() => this.seek_('live', 0)}
        place={isPast ? name : null}
        where={isPast ? '' : t('{0} steps', count(end))}
        transport={this.transport_}
        strip={{
          strip: this.strip_,
          content: this.content_.value,
          head: {
            record: record ?? end,
            text: isPast ? name : t('live'),
            glides: rate > 0 && !isAsked,
          },
          actions: {
            scrubbed: (to) => this.scrub_(to),
            selected: (pressed) => (this.strip_.selected.value = pressed),
            pressed: (event) => this.key_(event),
          },
        }}
        selection={{
          stroke,
          author: stroke ? this.authors_.nameOf(stroke.participant) : '',
          tool: stroke ? toolName(model.tool(stroke.tool)) : '',
          whyNot: model.welcome ? whyNotUndo(model.welcome) : '',
          note: this.note_.value,
          change: (change, one) => void this.change_(change, one),
        }}
        versions={this.versions_}
        compare={this.compare_}
      />
    );
  }

  private openChanged_(open: boolean): void {
    if (open) {
      this.timer_ ??= setInterval(() => this.update_(), UPDATE_MS);
      this.records_.invalidate();
      void this.authors_.load();
      this.update_();
    } else {
      this.compare_.end();
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

  /** Plays those that were wished for; a selected stroke may have been undone, or be longer now. */
  private strokesCame_(strokes: readonly Stroke[]): void {
    this.beginPart_();
    const selected = this.strip_.selected.peek();
    if (!selected) return;
    this.strip_.selected.value = strokes.find(({ id }) => id === selected.id) ?? null;
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
    if (!this.part_.isOver(nowMs)) {
      if (record !== this.record_) this.ask_(record, 0);
    } else if (this.record_ !== null) {
      this.ask_('live', 0); // again, if it was rejected
    } else if (!this.host.model.state?.at) {
      this.stopPlaying();
    }
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
    this.note_.value = '';
    this.seeker_.ask({ at, rate }, this.host.model.state, performance.now());
    this.showPlace_();
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
    this.showPlace_();
    if (!this.host.shell.isTimelineOpen.peek()) {
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
  private showPlace_(): void {
    const { state, participants } = this.host.model;
    const { wish, looksBack: isPast } = this.seeker_;
    participants.looksBack = isPast;
    const { record_: record } = this;
    const asked = wish && wish.at !== 'live' ? wish.rate : (state?.at?.rate ?? 0);
    const rate = this.part_ ? 1 : asked;
    const reached = record !== null && state?.at?.record === record ? state.at.time_ms : 0;
    const name = isPast ? this.describe_(record, reached) : '';
    const place: Place = { record, isPast, name, rate, isAsked: wish !== null };
    batch(() => {
      if (!isSamePlace(place, this.place_.peek())) this.place_.value = place;
      this.transport_.rate.value = isPast ? rate : 0;
      this.transport_.isLive.value = !isPast;
      this.compare_.place.value =
        isPast && record !== null ? t('Step {0}', count(record)) : t('Now');
    });
    const { end } = this.records_;
    if (asked > 0 && !wish && record !== null && record >= end && end > 0) this.seek_('live', 0);
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
      this.note_.value = done;
      this.records_.invalidate();
    } catch (problem) {
      this.tell_(problem);
    }
  }

  private tell_(problem: unknown): void {
    this.note_.value = sentence((problem as Error).message);
  }
}

function isSamePlace(a: Place, b: Place): boolean {
  return (Object.keys(a) as (keyof Place)[]).every((key) => a[key] === b[key]);
}
