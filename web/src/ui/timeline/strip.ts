// SPDX-License-Identifier: Apache-2.0
// The journal as a picture: a row of bars for each participant, forces and removal below, flags of the named
// versions above, and the playhead, which is a slider for pointer, keyboard and screen readers.

import { t } from '../../strings';
import type { Version } from '../../link/history';
import type { ForceCurve } from '../../model/force_curve';
import type { Stroke } from '../../model/stroke';
import { barsOf, recordAt, strokeAt, xOf, zoomed } from '../../model/timeline';
import type { Span, StrokeRow } from '../../model/timeline';
import { h } from '../dom';

export interface StripActions {
  /** The playhead was put on a record, at the right edge perhaps the last one. */
  scrubbed: (record: number) => void;
  /** A stroke, or none, was pressed. */
  selected: (stroke: Stroke | null) => void;
  /** A key on the playhead; true if it means something. */
  pressed: (event: KeyboardEvent) => boolean;
}

export interface StripContent {
  rows: readonly StrokeRow[];
  /** The last record. */
  end: number;
  versions: readonly Version[];
  forces: ForceCurve | null;
  colorOf: (participant: number) => string;
  nameOf: (participant: number) => string;
}

const ROW_PX = 15;
const ROWS_PX = 75; // of all rows together, unless there are too many
const ROW_MIN_PX = 4;
const FLAGS_PX = 12;
const FORCE_PX = 34;
const REMOVAL_PX = 22;
const GRAB_PX = 4; // a stroke so near to the pointer is meant
const PLOTS = [
  { name: t('Force'), color: '--force', height: FORCE_PX },
  { name: t('Removal'), color: '--removal', height: REMOVAL_PX },
];
const EMPTY: StripContent = {
  rows: [],
  end: 0,
  versions: [],
  forces: null,
  colorOf: () => '#888888',
  nameOf: () => '',
};

export class Strip {
  private readonly names_ = h('div', { class: 'timeline-names', 'aria-hidden': 'true' });
  private readonly canvas_ = h('canvas', { class: 'timeline-canvas', 'aria-hidden': 'true' });
  private readonly head_ = h('div', { class: 'timeline-head', 'aria-hidden': 'true' });
  /** The playhead. */
  readonly slider = h(
    'div',
    {
      class: 'timeline-track',
      role: 'slider',
      tabindex: '0',
      'aria-label': t('Position on the timeline'),
      'aria-orientation': 'horizontal',
      'aria-valuemin': '0',
    },
    this.canvas_,
    this.head_,
  );
  readonly element = h('div', { class: 'timeline-strip' }, this.names_, this.slider);
  private content_ = EMPTY;
  private span_: Span | null = null; // null: everything
  private selected_: Stroke | null = null;
  private head0_ = 0;
  private scrubs_ = false;

  constructor(private readonly actions: StripActions) {
    const { slider } = this;
    slider.addEventListener('pointerdown', (event) => this.down_(event));
    slider.addEventListener('pointermove', (event) => {
      if (this.scrubs_) this.scrub_(event);
    });
    const stop = (): void => {
      this.scrubs_ = false;
    };
    slider.addEventListener('pointerup', stop);
    slider.addEventListener('pointercancel', stop);
    slider.addEventListener('wheel', (event) => this.wheel_(event), { passive: false });
    slider.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !actions.pressed(event)) return;
      event.preventDefault();
      event.stopPropagation(); // the same keys turn the block
    });
    new ResizeObserver(() => this.draw_()).observe(slider);
  }

  show(content: StripContent): void {
    this.content_ = content;
    if (this.span_ && this.span_.to > content.end) this.span_ = null;
    this.draw_();
  }

  select(stroke: Stroke | null): void {
    this.selected_ = stroke;
    this.draw_();
  }

  /** Moves the playhead; `glides`: over the second until the next place is known. */
  place(record: number, text: string, glides: boolean): void {
    const { slider, head_: head } = this;
    this.head0_ = record;
    slider.setAttribute('aria-valuemax', String(this.content_.end));
    slider.setAttribute('aria-valuenow', String(record));
    slider.setAttribute('aria-valuetext', text);
    head.classList.toggle('glides', glides);
    const x = xOf(record, this.view_, this.width_);
    head.hidden = x < -1 || x > this.width_ + 1;
    head.style.transform = `translateX(${x.toFixed(1)}px)`;
  }

  /** Shows all of the journal again. */
  showAll(): void {
    this.span_ = null;
    this.draw_();
  }

  get isZoomed(): boolean {
    return this.span_ !== null;
  }

  private get view_(): Span {
    return this.span_ ?? { from: 0, to: Math.max(1, this.content_.end) };
  }

  private get width_(): number {
    return this.slider.clientWidth;
  }

  private get rowPx_(): number {
    const rows = Math.max(1, this.content_.rows.length);
    return Math.min(ROW_PX, Math.max(ROW_MIN_PX, Math.floor(ROWS_PX / rows)));
  }

  private down_(event: PointerEvent): void {
    if (event.button !== 0 || this.content_.end === 0) return;
    this.slider.setPointerCapture(event.pointerId);
    this.scrubs_ = true;
    const box = this.slider.getBoundingClientRect();
    const row = Math.floor((event.clientY - box.top - FLAGS_PX) / this.rowPx_);
    const { from, to } = this.view_;
    const slack = (GRAB_PX * (to - from)) / Math.max(1, this.width_);
    const record = recordAt(event.clientX - box.left, this.view_, this.width_);
    const strokes = this.content_.rows[row]?.strokes;
    this.actions.selected(strokes ? (strokeAt(strokes, record, slack) ?? null) : null);
    this.scrub_(event);
  }

  private scrub_(event: PointerEvent): void {
    const x = event.clientX - this.slider.getBoundingClientRect().left;
    this.actions.scrubbed(recordAt(x, this.view_, this.width_));
  }

  private wheel_(event: WheelEvent): void {
    event.preventDefault();
    const { end } = this.content_;
    const x = event.clientX - this.slider.getBoundingClientRect().left;
    const around = recordAt(x, this.view_, this.width_);
    const span = zoomed(this.view_, around, Math.exp(event.deltaY / 400), end);
    this.span_ = span.to - span.from < end ? span : null;
    this.draw_();
  }

  private draw_(): void {
    const { rows, nameOf, colorOf } = this.content_;
    const rowPx = this.rowPx_;
    const height = FLAGS_PX + Math.max(1, rows.length) * rowPx + FORCE_PX + REMOVAL_PX;
    this.slider.style.height = `${height}px`;
    this.names_.replaceChildren(
      ...rows.map(({ participant }) =>
        h(
          'div',
          { style: `height:${rowPx}px;--who:${colorOf(participant)}`, title: nameOf(participant) },
          rowPx > 10 ? h('span', {}, nameOf(participant)) : '',
        ),
      ),
      ...(this.content_.forces ? PLOTS.map(plotName) : []),
    );
    const context = this.canvas_.getContext('2d');
    if (context && this.width_ > 0) this.paint_(context, height, rowPx);
    const text = this.slider.getAttribute('aria-valuetext') ?? '';
    this.place(this.head0_, text, false);
  }

  private paint_(context: CanvasRenderingContext2D, height: number, rowPx: number): void {
    const ratio = Math.min(2, window.devicePixelRatio);
    const width = this.width_;
    this.canvas_.width = Math.round(width * ratio);
    this.canvas_.height = Math.round(height * ratio);
    context.scale(ratio, ratio);
    const style = getComputedStyle(this.slider);
    this.content_.rows.forEach((row, n) => {
      this.paintRow_(context, row, FLAGS_PX + n * rowPx, rowPx, style);
    });
    const top = height - FORCE_PX - REMOVAL_PX + 4;
    this.paintForces_(context, top, FORCE_PX - 5, style.getPropertyValue('--force'));
    const below = top + FORCE_PX;
    this.paintRemoval_(context, below, REMOVAL_PX - 6, style.getPropertyValue('--removal'));
    context.fillStyle = style.getPropertyValue('--accent');
    for (const { record } of this.content_.versions) {
      const x = xOf(record, this.view_, width);
      context.fillRect(x - 0.5, 0, 1, height);
      context.beginPath();
      context.moveTo(x, 0);
      context.lineTo(x + 9, 4);
      context.lineTo(x, 8);
      context.fill();
    }
  }

  private paintRow_(
    context: CanvasRenderingContext2D,
    { participant, strokes }: StrokeRow,
    top: number,
    rowPx: number,
    style: CSSStyleDeclaration,
  ): void {
    const color = this.content_.colorOf(participant);
    const hatch = hatchOf(context, color);
    const thick = rowPx > 6 ? rowPx - 3 : rowPx - 1;
    for (const { left, right, undone } of barsOf(strokes, this.view_, this.width_)) {
      context.fillStyle = undone ? hatch : color;
      context.fillRect(left, top, Math.max(1, right - left - 1), thick);
    }
    const selected = this.selected_;
    if (selected?.participant !== participant) return;
    const left = xOf(selected.id - 1, this.view_, this.width_);
    const right = xOf(selected.last, this.view_, this.width_);
    context.strokeStyle = style.getPropertyValue('--ink');
    context.lineWidth = 2;
    context.strokeRect(left, top, Math.max(3, right - left), thick);
  }

  /** The band of least to greatest forces, and the line of their means. */
  private paintForces_(
    context: CanvasRenderingContext2D,
    top: number,
    height: number,
    color: string,
  ): void {
    const { forces } = this.content_;
    if (!forces || forces.first.length === 0) return;
    const greatest = Math.max(...forces.maxN, 1e-6);
    const y = (value: number): number => top + height * (1 - value / greatest);
    context.fillStyle = color;
    forces.first.forEach((first, n) => {
      const left = xOf(first - 1, this.view_, this.width_);
      const right = xOf(forces.last[n]!, this.view_, this.width_);
      if (right < 0 || left > this.width_) return;
      const wide = Math.max(1, right - left);
      context.globalAlpha = 0.3;
      const high = y(forces.maxN[n]!);
      context.fillRect(left, high, wide, y(forces.minN[n]!) - high);
      context.globalAlpha = 1;
      context.fillRect(left, y(forces.meanN[n]!) - 0.75, wide, 1.5);
    });
  }

  /** The volume of a motion, as the mean of each span. */
  private paintRemoval_(
    context: CanvasRenderingContext2D,
    top: number,
    height: number,
    color: string,
  ): void {
    const { forces } = this.content_;
    if (!forces || forces.first.length === 0) return;
    const means = forces.removedMm3.map((mm3, n) => mm3 / Math.max(1, forces.motions[n]!));
    const greatest = Math.max(...means, 1e-9);
    context.fillStyle = color;
    forces.first.forEach((first, n) => {
      const left = xOf(first - 1, this.view_, this.width_);
      const right = xOf(forces.last[n]!, this.view_, this.width_);
      if (right < 0 || left > this.width_) return;
      const high = (height * Math.max(0, means[n]!)) / greatest;
      context.fillRect(left, top + height - high, Math.max(1, right - left), high);
    });
  }
}

/** A name at the side of a plot. */
function plotName({ name, color, height }: (typeof PLOTS)[number]): HTMLElement {
  return h('div', { style: `height:${height}px;--who:var(${color})` }, h('span', {}, name));
}

/** Diagonal lines in a color. */
function hatchOf(context: CanvasRenderingContext2D, color: string): CanvasPattern | string {
  const tile = new OffscreenCanvas(6, 6);
  const ink = tile.getContext('2d');
  if (!ink) return color;
  ink.strokeStyle = color;
  ink.lineWidth = 1.4;
  for (const x of [-6, 0, 6]) {
    ink.moveTo(x, 6);
    ink.lineTo(x + 6, 0);
  }
  ink.stroke();
  return context.createPattern(tile, 'repeat') ?? color;
}
