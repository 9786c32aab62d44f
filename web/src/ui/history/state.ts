// SPDX-License-Identifier: Apache-2.0
// Undo and redo of strokes, and the list of strokes while it is open.

import { effect, signal } from '@preact/signals';
import { t } from '../../strings';
import { changeStroke, listStrokes } from '../../link/strokes';
import type { Stroke, StrokeChange } from '../../model/stroke';
import type { SessionModel } from '../../model/session';
import { nextStroke, whyNotUndo } from '../../model/stroke_choice';
import { Authors } from '../authors';
import { sentence } from '../format';
import type { PersonChoice } from '../person_choice';

const REFRESH_MS = 1500; // while the list is open and the block changes

export class History {
  readonly authors: Authors;
  readonly isListOpen = signal(false);
  readonly isBusy = signal(false);
  /** The strokes as they were requested last, oldest first; null: not yet. */
  readonly strokes = signal<readonly Stroke[] | null>(null);
  private readonly note_ = signal('');
  private shownState_ = '';
  private shownMs_ = -Infinity;
  private timer_: ReturnType<typeof setTimeout> | undefined;

  constructor(
    readonly model: SessionModel,
    private readonly session: string,
    private readonly people: Pick<PersonChoice, 'selected'>,
  ) {
    this.authors = new Authors(model, session);
    effect(() => this.followBlock_());
  }

  /** Why this viewer may not undo, as a signal's value; empty: it may. */
  get whyNot(): string {
    const { welcome } = this.model;
    return welcome ? whyNotUndo(welcome) : '';
  }

  /** A sentence for the user, as a signal's value. */
  get note(): string {
    return this.whyNot || this.note_.value;
  }

  /** Undoes or redoes the next stroke of the selected participant. */
  async change(change: StrokeChange): Promise<void> {
    await this.attempt_(async () => {
      const strokes = await listStrokes(this.session);
      const stroke = nextStroke(strokes, change, this.people.selected);
      if (stroke) return this.changeOne_(change, stroke);
      return change === 'undo' ? t('There is nothing to undo.') : t('There is nothing to redo.');
    });
  }

  /** Undoes or redoes a stroke of the list. */
  changeStroke(change: StrokeChange, stroke: Stroke): void {
    void this.attempt_(() => this.changeOne_(change, stroke));
  }

  async toggleList(): Promise<void> {
    this.isListOpen.value = !this.isListOpen.peek();
    if (this.isListOpen.peek()) await this.refresh_();
  }

  /** Requests the strokes again after a change of the block, at most once in REFRESH_MS. */
  private followBlock_(): void {
    const { state } = this.model;
    const now = `${state?.motions} ${state?.removed_volume_mm3}`; // undo adds no motion
    if (!this.isListOpen.value || now === this.shownState_) return;
    this.shownState_ = now;
    this.timer_ ??= setTimeout(
      () => {
        this.timer_ = undefined;
        this.shownMs_ = performance.now();
        if (this.isListOpen.peek()) void this.refresh_();
      },
      Math.max(0, this.shownMs_ + REFRESH_MS - performance.now()),
    );
  }

  private async changeOne_(change: StrokeChange, stroke: Stroke): Promise<string> {
    await changeStroke(this.session, change, stroke.id);
    const { name } = this.model.participants.author(stroke.participant) ?? {};
    return changedText(change, name ?? '');
  }

  /** Runs a change and reports its outcome, also that of a failure. One at a time. */
  private async attempt_(act: () => Promise<string>): Promise<void> {
    if (this.isBusy.peek() || !this.model.welcome || this.whyNot !== '') return;
    this.isBusy.value = true;
    try {
      this.note_.value = await act();
    } catch (problem) {
      this.tell_(problem);
    }
    this.isBusy.value = false;
    if (this.isListOpen.peek()) await this.refresh_();
  }

  private async refresh_(): Promise<void> {
    try {
      const strokes = await listStrokes(this.session);
      if (strokes.some(({ participant }) => !this.authors.knows(participant)))
        await this.authors.load();
      this.strokes.value = strokes;
    } catch (problem) {
      this.tell_(problem);
    }
  }

  private tell_(problem: unknown): void {
    this.note_.value = sentence((problem as Error).message);
  }
}

/** @param name of who has carved the stroke; empty: unknown */
export function changedText(change: StrokeChange, name: string): string {
  if (name === '') return change === 'undo' ? t('A stroke was undone.') : t('A stroke was redone.');
  return change === 'undo'
    ? t('A stroke by {0} was undone.', name)
    : t('A stroke by {0} was redone.', name);
}
