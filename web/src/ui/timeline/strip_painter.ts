// SPDX-License-Identifier: Apache-2.0
// Paints the strip of the journal: a row of bars for each participant, forces and removal below, flags
// of the named versions above.

import type { Version } from '../../link/history';
import type { ForceCurve } from '../../model/force_curve';
import type { Stroke } from '../../model/stroke';
import { barsOf, xOf } from '../../model/timeline';
import type { Span, StrokeRow } from '../../model/timeline';

export interface StripContent {
  rows: readonly StrokeRow[];
  /** The last record. */
  end: number;
  versions: readonly Version[];
  forces: ForceCurve | null;
  /** Of each row, by its participant. */
  authors: ReadonlyMap<number, { name: string; color: string }>;
}

/** The records that the width of the strip shows. */
export interface StripPicture {
  content: StripContent;
  selected: Stroke | null;
  span: Span;
  /** CSS pixels. */
  width: number;
}

const ROW_PX = 15;
const ROWS_PX = 75; // of all rows together, unless there are too many
const ROW_MIN_PX = 4;
export const FLAGS_PX = 12;
export const FORCE_PX = 34;
export const REMOVAL_PX = 22;

/** The height of each of so many rows, CSS pixels. */
export function rowHeight(rows: number): number {
  return Math.min(ROW_PX, Math.max(ROW_MIN_PX, Math.floor(ROWS_PX / Math.max(1, rows))));
}

/** The height of the whole strip, CSS pixels. */
export function stripHeight(rows: number): number {
  return FLAGS_PX + Math.max(1, rows) * rowHeight(rows) + FORCE_PX + REMOVAL_PX;
}

export function paintStrip(canvas: HTMLCanvasElement, picture: StripPicture): void {
  const context = canvas.getContext('2d');
  const { content, width } = picture;
  if (!context || width <= 0) return;
  const { rows } = content;
  const height = stripHeight(rows.length);
  const ratio = Math.min(2, window.devicePixelRatio);
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  context.scale(ratio, ratio);
  const style = getComputedStyle(canvas);
  const rowPx = rowHeight(rows.length);
  rows.forEach((row, n) => {
    const ink = style.getPropertyValue('--ink');
    paintRow(context, picture, row, FLAGS_PX + n * rowPx, rowPx, ink);
  });
  const top = height - FORCE_PX - REMOVAL_PX + 4;
  context.fillStyle = style.getPropertyValue('--force');
  paintForces(context, picture, top, FORCE_PX - 5);
  context.fillStyle = style.getPropertyValue('--removal');
  paintRemoval(context, picture, top + FORCE_PX, REMOVAL_PX - 6);
  context.fillStyle = style.getPropertyValue('--accent');
  for (const { record } of content.versions) paintFlag(context, picture, record, height);
}

function paintFlag(
  context: CanvasRenderingContext2D,
  { span, width }: StripPicture,
  record: number,
  height: number,
): void {
  const x = xOf(record, span, width);
  context.fillRect(x - 0.5, 0, 1, height);
  context.beginPath();
  context.moveTo(x, 0);
  context.lineTo(x + 9, 4);
  context.lineTo(x, 8);
  context.fill();
}

function paintRow(
  context: CanvasRenderingContext2D,
  { content, selected, span, width }: StripPicture,
  { participant, strokes }: StrokeRow,
  top: number,
  rowPx: number,
  ink: string,
): void {
  const { color } = content.authors.get(participant)!;
  const hatch = hatchOf(context, color);
  const thick = rowPx > 6 ? rowPx - 3 : rowPx - 1;
  for (const { left, right, undone } of barsOf(strokes, span, width)) {
    context.fillStyle = undone ? hatch : color;
    context.fillRect(left, top, Math.max(1, right - left - 1), thick);
  }
  if (selected?.participant !== participant) return;
  const left = xOf(selected.id - 1, span, width);
  const right = xOf(selected.last, span, width);
  context.strokeStyle = ink;
  context.lineWidth = 2;
  context.strokeRect(left, top, Math.max(3, right - left), thick);
}

/** Calls `paint` for each span of the forces that is in view. */
function eachSpan(
  { content: { forces }, span, width }: StripPicture,
  paint: (n: number, left: number, wide: number) => void,
): void {
  forces?.first.forEach((first, n) => {
    const left = xOf(first - 1, span, width);
    const right = xOf(forces.last[n]!, span, width);
    if (right >= 0 && left <= width) paint(n, left, Math.max(1, right - left));
  });
}

/** The band of least to greatest forces, and the line of their means. */
function paintForces(
  context: CanvasRenderingContext2D,
  picture: StripPicture,
  top: number,
  height: number,
): void {
  const { forces } = picture.content;
  if (!forces) return;
  const greatest = Math.max(...forces.maxN, 1e-6);
  const y = (value: number): number => top + height * (1 - value / greatest);
  eachSpan(picture, (n, left, wide) => {
    context.globalAlpha = 0.3;
    const high = y(forces.maxN[n]!);
    context.fillRect(left, high, wide, y(forces.minN[n]!) - high);
    context.globalAlpha = 1;
    context.fillRect(left, y(forces.meanN[n]!) - 0.75, wide, 1.5);
  });
}

/** The volume of a motion, as the mean of each span. */
function paintRemoval(
  context: CanvasRenderingContext2D,
  picture: StripPicture,
  top: number,
  height: number,
): void {
  const { forces } = picture.content;
  if (!forces) return;
  const means = forces.removedMm3.map((mm3, n) => mm3 / Math.max(1, forces.motions[n]!));
  const greatest = Math.max(...means, 1e-9);
  eachSpan(picture, (n, left, wide) => {
    const high = (height * Math.max(0, means[n]!)) / greatest;
    context.fillRect(left, top + height - high, wide, high);
  });
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
