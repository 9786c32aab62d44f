// SPDX-License-Identifier: Apache-2.0
// The text of a program as a list of which only the rows in view exist, with the live line marked.

import { t } from '../../strings';
import { LineIndex, rowsInView } from '../../model/line_index';
import { h } from '../dom';

const ROW_PX = 20; // programs.css
const MORE_ROWS = 8;
/** Browsers draw nothing below some 17 million pixels. */
const ROWS_MAX = 800_000;

export interface Mark {
  line: number;
  /** The word in it; empty: the line. */
  word: string;
  /** Nothing is wrong there: its place is marked in the picture. */
  isPlace?: boolean;
}

export class TextView {
  private readonly rows_ = h('div', { class: 'program-rows' });
  readonly element = h(
    'div',
    {
      class: 'program-text',
      tabindex: '0',
      role: 'region',
      'aria-label': t('Program text'),
    },
    this.rows_,
  );
  private lines_ = new LineIndex('');
  private live_ = 0;
  private mark_: Mark = { line: 0, word: '' };
  /** Whether the text moves with the live line; scrolling ends that. */
  private follows_ = true;
  private scrolledTo_ = 0;

  /** @param pressed a line was pressed */
  constructor(
    private readonly followChanged: (follows: boolean) => void,
    pressed: (line: number) => void = () => undefined,
  ) {
    this.rows_.addEventListener('click', ({ target }) => {
      const row = (target as Element).closest('.program-row');
      if (row && getSelection()?.isCollapsed !== false)
        pressed(Number(row.getAttribute('data-line')));
    });
    this.element.addEventListener('scroll', () => {
      if (Math.abs(this.element.scrollTop - this.scrolledTo_) > ROW_PX) this.follow(false);
      this.draw_();
    });
    new ResizeObserver(() => this.draw_()).observe(this.element);
  }

  get follows(): boolean {
    return this.follows_;
  }

  show(text: string): void {
    this.lines_ = new LineIndex(text);
    this.mark_ = { line: 0, word: '' };
    this.rows_.style.height = `${Math.min(this.lines_.count, ROWS_MAX) * ROW_PX}px`;
    this.rows_.style.setProperty('--digits', String(String(this.lines_.count).length));
    this.live_ = 0;
    this.scroll_(1);
    this.draw_();
  }

  /** Marks the line that is being carved; 0: none. */
  setLive(line: number): void {
    if (line === this.live_) return;
    this.live_ = line;
    if (this.follows_ && line > 0) this.scroll_(line);
    this.draw_();
  }

  /** Marks a line, e.g. of an error, and brings it into view unless it is. */
  mark(mark: Mark): void {
    this.mark_ = mark;
    this.follow(false);
    const { scrollTop, clientHeight } = this.element;
    const top = (mark.line - 1) * ROW_PX;
    if (top < scrollTop || top + ROW_PX > scrollTop + clientHeight) this.scroll_(mark.line);
    this.draw_();
  }

  follow(follows: boolean): void {
    if (follows && this.live_ > 0) this.scroll_(this.live_);
    if (follows === this.follows_) return;
    this.follows_ = follows;
    this.followChanged(follows);
  }

  private scroll_(line: number): void {
    const middle = (line - 1) * ROW_PX - this.element.clientHeight / 2 + ROW_PX / 2;
    this.element.scrollTop = Math.max(0, middle);
    this.scrolledTo_ = this.element.scrollTop;
  }

  private draw_(): void {
    const { scrollTop, clientHeight } = this.element;
    const count = Math.min(this.lines_.count, ROWS_MAX);
    const { first, past } = rowsInView(scrollTop, clientHeight, ROW_PX, count, MORE_ROWS);
    const rows: HTMLElement[] = [];
    for (let n = first; n < past; n += 1) rows.push(this.row_(n + 1));
    this.rows_.replaceChildren(...rows);
  }

  private row_(line: number): HTMLElement {
    const row = h(
      'div',
      { class: 'program-row', style: `top:${(line - 1) * ROW_PX}px` },
      h('span', { class: 'program-number', 'aria-hidden': 'true' }, String(line)),
      ...this.content_(line),
    );
    if (line === this.live_) row.setAttribute('aria-current', 'true');
    row.setAttribute('data-line', String(line));
    if (line === this.mark_.line) row.classList.add(this.mark_.isPlace ? 'placed' : 'marked');
    return row;
  }

  private content_(line: number): (Node | string)[] {
    const text = this.lines_.line(line);
    const { word } = this.mark_;
    const at = line === this.mark_.line && word !== '' ? text.indexOf(word) : -1;
    if (at < 0) return [text];
    return [text.slice(0, at), h('mark', {}, word), text.slice(at + word.length)];
  }
}
