// SPDX-License-Identifier: Apache-2.0
// The stroke that was pressed: whose it is, and its undo or redo.

import { language, t } from '../../strings';
import type { Stroke, StrokeChange } from '../../model/stroke';
import { h, setText } from '../dom';

export const CLOCK = new Intl.DateTimeFormat(language, { timeStyle: 'medium', hourCycle: 'h23' });

export class Selection {
  private readonly text_ = h('span', {}, t('Click a bar to select its stroke.'));
  private readonly change_ = h(
    'button',
    { type: 'button', class: 'timeline-action', hidden: '' },
    t('Undo'),
  );
  private readonly note_ = h('span', { class: 'timeline-note', role: 'status' });
  readonly element = h('p', { class: 'timeline-selection' }, this.text_, this.change_, this.note_);
  private stroke_: Stroke | null = null;

  /** @param change is called with the change that the button names */
  constructor(change: (change: StrokeChange, stroke: Stroke) => void) {
    this.change_.addEventListener('click', () => {
      if (this.stroke_) change(this.stroke_.undone ? 'redo' : 'undo', this.stroke_);
    });
  }

  /** @param author its name; `why`: why this viewer may not undo, empty if it may */
  show(stroke: Stroke | null, author: string, tool: string, why: string): void {
    this.stroke_ = stroke;
    this.change_.hidden = !stroke;
    if (!stroke) {
      setText(this.text_, t('Click a bar to select its stroke.'));
      return;
    }
    const undone = stroke.undone ? t(' · undone') : '';
    const time = CLOCK.format(stroke.begin_ms);
    setText(this.text_, `${author} · ${tool} · ${time}${undone}`);
    const label = stroke.undone ? t('Redo') : t('Undo');
    setText(this.change_, label);
    const what = stroke.undone
      ? t('Redo this stroke by {0}', author)
      : t('Undo this stroke by {0}', author);
    this.change_.setAttribute('aria-label', what);
    this.change_.disabled = why !== '';
    this.change_.title = why;
  }

  /** Says how something ended. */
  note(text: string): void {
    setText(this.note_, text);
  }
}
