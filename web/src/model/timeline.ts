// SPDX-License-Identifier: Apache-2.0
// The journal along a line: which record is where, and the strokes as bars of which there are never
// more than pixels.

import type { Stroke } from './stroke';
import type { StateMessage } from '../wire/types';

/** The records in view, `from` at the left edge and `to` at the right one. */
export interface Span {
  from: number;
  to: number;
}

/** A bar in CSS pixels from the left edge. */
export interface Bar {
  left: number;
  right: number;
  undone: boolean;
}

/** The strokes of one participant, oldest first. */
export interface StrokeRow {
  participant: number;
  strokes: Stroke[];
}

/** Groups strokes, given oldest first, by their participants, in the order of their first strokes. */
export function rowsOf(strokes: readonly Stroke[]): StrokeRow[] {
  const rows = new Map<number, StrokeRow>();
  for (const stroke of strokes) {
    const row = rows.get(stroke.participant);
    if (row) row.strokes.push(stroke);
    else rows.set(stroke.participant, { participant: stroke.participant, strokes: [stroke] });
  }
  return [...rows.values()];
}

export function xOf(record: number, { from, to }: Span, width: number): number {
  return ((record - from) / Math.max(1, to - from)) * width;
}

/** The record under a point, one that is in view. */
export function recordAt(x: number, { from, to }: Span, width: number): number {
  const part = Math.min(1, Math.max(0, x / Math.max(1, width)));
  return Math.round(from + part * (to - from));
}

/** Index of the first of the strokes, oldest first, that ends at the record or later. */
function firstEnding(strokes: readonly Stroke[], record: number): number {
  let low = 0;
  let high = strokes.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (strokes[middle]!.last < record) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * The strokes of one participant in view as bars. A stroke that is thinner than a pixel belongs to the
 * bar before it if that is less than a pixel away, so that there are at most two bars a pixel, however
 * many strokes. A bar in which any stroke stands is not undone, unless that stroke is thinner than a
 * pixel and the bar is not.
 */
export function barsOf(strokes: readonly Stroke[], span: Span, width: number): Bar[] {
  const bars: Bar[] = [];
  let bar: Bar | undefined;
  for (let n = firstEnding(strokes, span.from); n < strokes.length; n += 1) {
    const { id, last, undone } = strokes[n]!;
    if (id > span.to) break;
    const left = Math.max(0, xOf(id - 1, span, width));
    const right = Math.min(width, xOf(last, span, width));
    const isThin = right - left < 1;
    if (bar && isThin && left - bar.right < 1) {
      if (bar.right - bar.left < 1) bar.undone &&= undone;
      bar.right = Math.max(bar.right, right);
    } else {
      bar = { left, right, undone };
      bars.push(bar);
    }
  }
  return bars;
}

/** The stroke at a record, or the nearest that is at most `slack` records away. */
export function strokeAt(
  strokes: readonly Stroke[],
  record: number,
  slack: number,
): Stroke | undefined {
  const at = firstEnding(strokes, record);
  const near = [strokes[at - 1], strokes[at]].map((stroke) => ({
    stroke,
    distance: stroke ? Math.max(stroke.id - record, record - stroke.last, 0) : Infinity,
  }));
  const [before, after] = near as [(typeof near)[0], (typeof near)[0]];
  const best = before.distance < after.distance ? before : after;
  return best.distance <= slack ? best.stroke : undefined;
}

/** Zooms by a factor (below 1: in) around a record, within 0 to `end`. */
export function zoomed(span: Span, around: number, factor: number, end: number): Span {
  const length = Math.min(end, Math.max(20, (span.to - span.from) * factor));
  const part = (around - span.from) / Math.max(1, span.to - span.from);
  const from = Math.min(Math.max(0, around - part * length), end - length);
  return { from, to: from + length };
}

/** Replaces the strokes from the record `since` on by newer ones. */
export function joined(
  old: readonly Stroke[],
  since: number,
  newer: readonly Stroke[],
): readonly Stroke[] {
  if (since === 0) return newer;
  return [...old.filter(({ id }) => id < since), ...newer];
}

/** From which record the list of strokes has to be asked again, since newer motions may be in it. */
export function openSince(rows: readonly StrokeRow[]): number {
  return rows.reduce(
    (since, { strokes }) => Math.min(since, strokes.at(-1)?.id ?? since),
    rows.length === 0 ? 0 : Infinity,
  );
}

/**
 * Whether strokes may have been undone or redone between two states of the present: the block has
 * changed without a motion, or there is more of it.
 */
export function mayHaveUndone(before: StateMessage, now: StateMessage): boolean {
  if (now.removed_volume_mm3 < before.removed_volume_mm3) return true;
  return now.motions === before.motions && now.state_hash !== before.state_hash;
}
