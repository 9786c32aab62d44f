// SPDX-License-Identifier: Apache-2.0
// The journal as a picture, and the playhead over it, which is a slider for pointer, keyboard and screen
// readers.

import { signal, useSignal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../../strings';
import type { Stroke } from '../../model/stroke';
import { recordAt, strokeAt, xOf, zoomed } from '../../model/timeline';
import type { Span } from '../../model/timeline';
import {
  FLAGS_PX,
  FORCE_PX,
  paintStrip,
  REMOVAL_PX,
  rowHeight,
  stripHeight,
} from './strip_painter';
import type { StripContent } from './strip_painter';

const GRAB_PX = 4; // a stroke so near to the pointer is meant
const PLOTS = [
  { name: t('Force'), color: '--force', height: FORCE_PX },
  { name: t('Removal'), color: '--removal', height: REMOVAL_PX },
];

/** Where the playhead is. */
export interface Head {
  record: number;
  text: string;
  /** It moves over the second until the next place is known. */
  glides: boolean;
}

export class Strip {
  /** The part of the journal in view; null: all. */
  private readonly zoom_ = signal<Span | null>(null);
  readonly selected = signal<Stroke | null>(null);

  get isZoomed(): boolean {
    return this.zoom_.value !== null;
  }

  /** The records in view of a journal with `end` records. */
  span(end: number): Span {
    const { value: zoom } = this.zoom_;
    return zoom && zoom.to <= end ? zoom : { from: 0, to: Math.max(1, end) };
  }

  zoom(around: number, factor: number, end: number): void {
    const span = zoomed(this.span(end), around, factor, end);
    this.zoom_.value = span.to - span.from < end ? span : null;
  }
}

interface StripActions {
  /** The playhead was put on a record, at the right edge perhaps the last one. */
  scrubbed: (record: number) => void;
  /** A stroke, or none, was pressed. */
  selected: (stroke: Stroke | null) => void;
  /** A key on the playhead; true if it means something. */
  pressed: (event: KeyboardEvent) => boolean;
}

interface StripProps {
  strip: Strip;
  content: StripContent;
  head: Head;
  actions: StripActions;
  /** Becomes true when the playhead is to have the focus. */
  hasFocus: boolean;
}

function Names({ content: { rows, forces, authors } }: { content: StripContent }) {
  const rowPx = rowHeight(rows.length);
  return (
    <div class="timeline-names" aria-hidden="true">
      {rows.map(({ participant }) => {
        const { name, color } = authors.get(participant)!;
        return (
          <div key={participant} style={`height:${rowPx}px;--who:${color}`} title={name}>
            {rowPx > 10 && <span>{name}</span>}
          </div>
        );
      })}
      {forces &&
        PLOTS.map(({ name, color, height }) => (
          <div key={name} style={`height:${height}px;--who:var(${color})`}>
            <span>{name}</span>
          </div>
        ))}
    </div>
  );
}

type TrackEvent<E> = E & { currentTarget: HTMLElement };

/** The handlers of pointer and keyboard on the strip. */
function handlersOf({ strip, content, actions }: StripProps) {
  const { rows, end } = content;
  const xIn = ({ clientX, currentTarget }: TrackEvent<MouseEvent>): number =>
    clientX - currentTarget.getBoundingClientRect().left;
  const recordOf = (event: TrackEvent<MouseEvent>): number =>
    recordAt(xIn(event), strip.span(end), event.currentTarget.clientWidth);
  const press = (event: TrackEvent<PointerEvent>): void => {
    const { clientWidth } = event.currentTarget;
    const { top } = event.currentTarget.getBoundingClientRect();
    const row = Math.floor((event.clientY - top - FLAGS_PX) / rowHeight(rows.length));
    const { from, to } = strip.span(end);
    const slack = (GRAB_PX * (to - from)) / Math.max(1, clientWidth);
    const strokes = rows[row]?.strokes;
    actions.selected(strokes ? (strokeAt(strokes, recordOf(event), slack) ?? null) : null);
  };
  return {
    onPointerDown: (event: TrackEvent<PointerEvent>) => {
      if (event.button !== 0 || end === 0) return;
      event.currentTarget.setPointerCapture(event.pointerId);
      press(event);
      actions.scrubbed(recordOf(event));
    },
    onPointerMove: (event: TrackEvent<PointerEvent>) => {
      if (event.currentTarget.hasPointerCapture(event.pointerId)) actions.scrubbed(recordOf(event));
    },
    onWheel: (event: TrackEvent<WheelEvent>) => {
      event.preventDefault();
      strip.zoom(recordOf(event), Math.exp(event.deltaY / 400), end);
    },
    onKeyDown: (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !actions.pressed(event)) return;
      event.preventDefault();
      event.stopPropagation(); // the same keys turn the block
    },
  };
}

export function StripView(props: StripProps) {
  const { strip, content, head, hasFocus } = props;
  const track = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const width = useSignal(0);
  const span = strip.span(content.end);
  useLayoutEffect(() => {
    const { current } = track;
    if (!current) return;
    const observer = new ResizeObserver(() => (width.value = current.clientWidth));
    observer.observe(current);
    return () => observer.disconnect();
  }, []);
  useLayoutEffect(() => {
    if (hasFocus) track.current?.focus();
  }, [hasFocus]);
  const { value: selected } = strip.selected;
  const { value: wide } = width;
  useLayoutEffect(() => {
    if (canvas.current) paintStrip(canvas.current, { content, selected, span, width: wide });
  }, [content, selected, span.from, span.to, wide]);
  const x = xOf(head.record, span, wide);
  return (
    <div class="timeline-strip">
      <Names content={content} />
      <div
        ref={track}
        class="timeline-track"
        role="slider"
        tabIndex={0}
        aria-label={t('Position on the timeline')}
        aria-orientation="horizontal"
        aria-valuemin={0}
        aria-valuemax={content.end}
        aria-valuenow={head.record}
        aria-valuetext={head.text}
        style={`height:${stripHeight(content.rows.length)}px`}
        {...handlersOf(props)}
      >
        <canvas ref={canvas} class="timeline-canvas" aria-hidden="true" />
        <div
          key={`${span.from} ${span.to} ${wide}`} // another scale: the head does not glide to its place
          class={head.glides ? 'timeline-head glides' : 'timeline-head'}
          aria-hidden="true"
          hidden={x < -1 || x > wide + 1}
          style={`transform:translateX(${x.toFixed(1)}px)`}
        />
      </div>
    </div>
  );
}
