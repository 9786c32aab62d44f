// SPDX-License-Identifier: Apache-2.0
// The strokes of a session, newest first: author, tool, time; each can be undone or redone.

import { language, t } from '../strings';
import type { Stroke, StrokeChange } from '../model/stroke';
import type { SessionModel } from '../model/session';
import { toolName } from '../model/tool_profile';
import type { Authors } from './authors';
import { h } from './dom';
import { count } from './format';

const SHOWN_MAX = 200;
const CLOCK = new Intl.DateTimeFormat(language, { timeStyle: 'medium', hourCycle: 'h23' });

export class StrokeList {
  readonly element = h('ol', { class: 'strokes', 'aria-label': t('Strokes, newest first') });

  constructor(
    private readonly model: SessionModel,
    private readonly authors: Authors,
    private readonly change: (change: StrokeChange, stroke: Stroke) => void,
  ) {}

  /** Shows these strokes, given oldest first. */
  show(strokes: readonly Stroke[]): void {
    const newest = strokes.slice(-SHOWN_MAX).reverse();
    this.element.replaceChildren(...newest.map((stroke) => this.row_(stroke)));
    const hidden = strokes.length - newest.length;
    if (hidden > 0)
      this.element.append(h('li', { class: 'quiet' }, t('{0} older strokes', count(hidden))));
    if (strokes.length === 0)
      this.element.append(h('li', { class: 'quiet' }, t('No strokes yet.')));
  }

  private row_(stroke: Stroke): HTMLElement {
    const name = this.authors.nameOf(stroke.participant);
    const tool = toolName(this.model.tool(stroke.tool));
    const change: StrokeChange = stroke.undone ? 'redo' : 'undo';
    const label = change === 'undo' ? t('Undo') : t('Redo');
    const time = CLOCK.format(stroke.begin_ms);
    const button = h(
      'button',
      { type: 'button', class: 'quiet-action', 'aria-label': `${label} ${name}, ${time}` },
      label,
    );
    button.addEventListener('click', () => this.change(change, stroke));
    return h(
      'li',
      {
        class: stroke.undone ? 'stroke undone' : 'stroke',
        style: `--who:${this.authors.colorOf(stroke.participant)}`,
      },
      h('span', { class: 'stroke-dot' }),
      h('span', {}, name, h('small', {}, `${tool} · ${time}`)),
      button,
    );
  }
}
