// SPDX-License-Identifier: Apache-2.0
// Undo and redo of strokes. The buttons are here; the list of strokes is a chunk of its own, loaded
// when it is first opened.

import { t } from '../strings';
import { changeStroke, listStrokes } from '../link/strokes';
import type { Stroke, StrokeChange } from '../model/stroke';
import type { SessionModel } from '../model/session';
import { nextStroke, whyNotUndo } from '../model/stroke_choice';
import { Authors } from './authors';
import { h, setText } from './dom';
import { sentence } from './format';
import type { StrokeList } from './stroke_list';

const REFRESH_MS = 1500; // while the list is open and the block changes

export class History {
  readonly element: HTMLElement;
  private readonly undo_ = this.button_(t('Undo'), t('Ctrl+Z'), 'undo');
  private readonly redo_ = this.button_(t('Redo'), t('Ctrl+Shift+Z'), 'redo');
  private readonly toggle_ = h(
    'button',
    { type: 'button', class: 'quiet-action', 'aria-expanded': 'false' },
    t('Show strokes'),
  );
  private readonly note_ = h('p', { class: 'quiet history-note', role: 'status' });
  private readonly body_ = h('div', { hidden: '' });
  private readonly authors_: Authors;
  private list_: StrokeList | null = null;
  private selected_: number | null = null;
  private busy_ = false;
  private shownState_ = '';
  private shownMs_ = -Infinity;

  constructor(
    private readonly model: SessionModel,
    private readonly session: string,
  ) {
    this.authors_ = new Authors(model, session);
    this.element = h(
      'div',
      {},
      h('div', { class: 'history-actions' }, this.undo_, this.redo_, this.toggle_),
      this.note_,
      this.body_,
    );
    this.toggle_.addEventListener('click', () => void this.open_(this.body_.hidden));
  }

  /** `selected`: the participant whose strokes the buttons mean; null: the newest of all. */
  update(selected: number | null, nowMs: number): void {
    this.selected_ = selected;
    const { welcome, state } = this.model;
    const reason = welcome ? whyNotUndo(welcome) : '';
    for (const button of [this.undo_, this.redo_]) {
      const isDisabled = String(reason !== '' || this.busy_);
      if (button.getAttribute('aria-disabled') !== isDisabled)
        button.setAttribute('aria-disabled', isDisabled);
    }
    if (reason !== '') setText(this.note_, reason);
    const now = `${state?.motions} ${state?.removed_volume_mm3}`; // undo adds no motion
    const isDue = now !== this.shownState_ && nowMs - this.shownMs_ > REFRESH_MS;
    if (this.body_.hidden || !isDue) return;
    this.shownState_ = now;
    this.shownMs_ = nowMs;
    void this.refresh_();
  }

  /** Undoes or redoes the next stroke of the selected participant. */
  async change(change: StrokeChange): Promise<void> {
    await this.attempt_(async () => {
      const stroke = nextStroke(await listStrokes(this.session), change, this.selected_);
      if (!stroke)
        return change === 'undo' ? t('There is nothing to undo.') : t('There is nothing to redo.');
      return this.changeOne_(change, stroke);
    });
  }

  private button_(label: string, key: string, change: StrokeChange): HTMLButtonElement {
    const title =
      change === 'undo'
        ? t("Undo the selected participant's last stroke ({0})", key)
        : t("Redo the selected participant's last stroke ({0})", key);
    const button = h('button', { type: 'button', class: 'history-button', title }, label);
    button.addEventListener('click', () => void this.change(change));
    return button;
  }

  private async changeOne_(change: StrokeChange, stroke: Stroke): Promise<string> {
    await changeStroke(this.session, change, stroke.id);
    const { name } = this.model.participants.author(stroke.participant) ?? {};
    return changedText(change, name ?? '');
  }

  /** Runs a change and tells its outcome, also that of a failure. One at a time. */
  private async attempt_(act: () => Promise<string>): Promise<void> {
    const { welcome } = this.model;
    if (this.busy_ || !welcome || whyNotUndo(welcome) !== '') return;
    this.busy_ = true;
    try {
      setText(this.note_, await act());
    } catch (problem) {
      setText(this.note_, sentence((problem as Error).message));
    }
    this.busy_ = false;
    if (!this.body_.hidden) await this.refresh_();
  }

  private async open_(open: boolean): Promise<void> {
    this.body_.hidden = !open;
    this.toggle_.setAttribute('aria-expanded', String(open));
    setText(this.toggle_, open ? t('Hide strokes') : t('Show strokes'));
    if (!open) return;
    if (!this.list_) {
      const { StrokeList } = await import('./stroke_list');
      this.list_ ??= new StrokeList(this.model, this.authors_, (change, stroke) => {
        void this.attempt_(() => this.changeOne_(change, stroke));
      });
      this.body_.replaceChildren(this.list_.element);
    }
    await this.refresh_();
  }

  private async refresh_(): Promise<void> {
    try {
      const strokes = await listStrokes(this.session);
      if (strokes.some(({ participant }) => !this.authors_.knows(participant)))
        await this.authors_.load();
      this.list_?.show(strokes);
    } catch (problem) {
      setText(this.note_, sentence((problem as Error).message));
    }
  }
}

/** @param name of who has carved the stroke; empty: unknown */
export function changedText(change: StrokeChange, name: string): string {
  if (name === '') return change === 'undo' ? t('A stroke was undone.') : t('A stroke was redone.');
  return change === 'undo'
    ? t('A stroke by {0} was undone.', name)
    : t('A stroke by {0} was redone.', name);
}
