// SPDX-License-Identifier: Apache-2.0
// The path of an NC program: which part of it has been carved, which part a line of the text is, and
// which line is meant by a place near the path.

import type { Vec3 } from '../wire/types';

export type PathKind = 'placed' | 'rapid' | 'feed';

export interface ProgramPath {
  /** Points of the tip, three numbers each, mm. */
  points: Float32Array;
  /** The line of the text that led to each point. */
  lines: Uint32Array;
  /** How the tool came to each point. */
  kinds: PathKind[];
  /** When the tool is at each point, at feed rate, s. */
  timesS: Float64Array;
  /** No point of the real path is farther from the drawn one. */
  errorMm: number;
}

const KINDS: Partial<Record<string, PathKind>> = { s: 'placed', r: 'rapid', f: 'feed' };

/** What `GET …/path` answers (server/http/README.md). */
export function pathOfAnswer(answer: unknown): ProgramPath {
  const from = (answer ?? {}) as Record<string, unknown>;
  const column = (name: string): number[] => {
    const values = from[name];
    return Array.isArray(values) ? values.map(Number) : [];
  };
  const [x, y, z, line, time] = ['x_mm', 'y_mm', 'z_mm', 'line', 'time_s'].map(column) as [
    number[],
    number[],
    number[],
    number[],
    number[],
  ];
  const letters = typeof from['kind'] === 'string' ? from['kind'] : '';
  const count = Math.min(x.length, y.length, z.length, line.length, letters.length);
  const points = new Float32Array(3 * count);
  for (let n = 0; n < count; n += 1) points.set([x[n]!, y[n]!, z[n]!], 3 * n);
  return {
    points,
    lines: Uint32Array.from(line.slice(0, count)),
    kinds: Array.from({ length: count }, (_, n) => KINDS[letters[n]!] ?? 'feed'),
    timesS: Float64Array.from({ length: count }, (_, n) => time[n] ?? 0),
    errorMm: Number(from['error_mm'] ?? 0),
  };
}

/**
 * Where the tool is at a time of the program, and the number of the point to which it moves then;
 * null: there is no path.
 */
export function placeAt(path: ProgramPath, timeS: number): { point: number; tip: Vec3 } | null {
  const { timesS } = path;
  const last = timesS.length - 1;
  if (last < 0) return null;
  let [low, high] = [0, last];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (timesS[middle]! < timeS) low = middle + 1;
    else high = middle;
  }
  const to = pointOf(path, low);
  const [beganS, endsS] = [timesS[Math.max(0, low - 1)]!, timesS[low]!];
  if (low === 0 || path.kinds[low] === 'placed' || endsS <= beganS) return { point: low, tip: to };
  const part = Math.min(1, (timeS - beganS) / (endsS - beganS));
  const from = pointOf(path, low - 1);
  const [x, y, z] = from.map((value, k) => value + part * (to[k]! - value)) as Vec3;
  return { point: low, tip: [x, y, z] };
}

/** Columns of equal length: the feed until `timesS`, since the time before, mm/min. */
export interface FeedCurve {
  timesS: number[];
  /** null: a rapid. */
  feeds: (number | null)[];
}

/** How fast the tip moves along the path. Parts that take no time are left out. */
export function feedCurveOf({ points, kinds, timesS }: ProgramPath): FeedCurve {
  const curve: FeedCurve = { timesS: [], feeds: [] };
  let beganS = timesS[0] ?? 0;
  let length = 0;
  for (let n = 1; n < kinds.length; n += 1) {
    const isMove = kinds[n] !== 'placed';
    if (isMove)
      length += Math.hypot(...[0, 1, 2].map((k) => points[3 * n + k]! - points[3 * n - 3 + k]!));
    const spanS = timesS[n]! - beganS;
    if (!(spanS > 0)) continue;
    if (curve.timesS.length === 0) curve.timesS.push(beganS);
    curve.timesS.push(timesS[n]!);
    curve.feeds.push(kinds[n] === 'feed' ? (60 * length) / spanS : null);
    beganS = timesS[n]!;
    length = 0;
  }
  if (curve.feeds.length > 0) curve.feeds.unshift(curve.feeds[0]!);
  return curve;
}

/**
 * Corners of the curve for a plot that joins consecutive points and leaves gaps at nulls: two for each
 * span, so that a feed between two rapids is drawn, too.
 */
export function cornersOf({ timesS, feeds }: FeedCurve): [number[], (number | null)[]] {
  const spans = timesS.slice(1);
  const times = spans.flatMap((endS, n) => [timesS[n]!, endS]);
  return [times, spans.flatMap((_, n) => [feeds[n + 1]!, feeds[n + 1]!])];
}

/** The feed at a time; null: a rapid, or nothing moves then. */
export function feedAt({ timesS, feeds }: FeedCurve, timeS: number): number | null {
  const n = timesS.findIndex((endS, k) => k > 0 && endS >= timeS);
  return n < 0 || timeS < timesS[0]! ? null : feeds[n]!;
}

export function pointOf({ points }: ProgramPath, n: number): Vec3 {
  return [points[3 * n]!, points[3 * n + 1]!, points[3 * n + 2]!];
}

/** Whether a line that has no point of its own comes behind the point `n`, or the path begins later. */
function isBefore(lines: Uint32Array, n: number, line: number): boolean {
  if (lines[n]! > line) return n === 0;
  return n === lines.length - 1 || lines[n + 1]! > line;
}

/**
 * The number of the point that the tool has reached; for a line without points, that of a place
 * before it. Where lines repeat, as in subprograms, the share of the motions that are done says which
 * time it is.
 */
export function reached({ lines }: ProgramPath, line: number, share: number): number {
  if (share >= 1) return lines.length - 1;
  const expected = share * (lines.length - 1);
  const hasPoints = lines.includes(line);
  let best = -1;
  for (let n = 0; n < lines.length; n += 1) {
    const fits = hasPoints ? lines[n] === line : isBefore(lines, n, line);
    if (!fits) continue;
    if (best < 0 || Math.abs(n - expected) <= Math.abs(best - expected)) best = n;
  }
  return Math.max(0, best);
}

/**
 * The points, from the first to the last, to which a line of the text leads: of a line that moves
 * nothing, or whose points were left out, the first place before it. Null: there is no path.
 */
export function pointsOfLine({ lines }: ProgramPath, line: number): [number, number] | null {
  if (lines.length === 0) return null;
  const first = lines.indexOf(line);
  if (first >= 0) {
    let last = first;
    while (lines[last + 1] === line) last += 1;
    return [first, last];
  }
  const before = lines.findIndex((_, n) => isBefore(lines, n, line));
  return [before, before];
}

/**
 * The number of the point to which the part of the path leads that is nearest to a place of the
 * picture, at most `mostPx` away; -1: none.
 * @param matrix takes points to the picture's clip coordinates, by columns
 * @param size of the picture, CSS pixels
 */
export function nearestInPicture(
  path: ProgramPath,
  matrix: ArrayLike<number>,
  size: { width: number; height: number },
  place: { x: number; y: number },
  mostPx: number,
): number {
  const { points, kinds } = path;
  let best = -1;
  let least = mostPx * mostPx;
  let [fromX, fromY, isBefore] = [0, 0, false];
  for (let n = 0; n < kinds.length; n += 1) {
    const [x, y, z] = [points[3 * n]!, points[3 * n + 1]!, points[3 * n + 2]!];
    const clip = (row: number): number =>
      matrix[row]! * x + matrix[row + 4]! * y + matrix[row + 8]! * z + matrix[row + 12]!;
    const w = clip(3);
    const isSeen = w > 0;
    const toX = ((clip(0) / w + 1) / 2) * size.width - place.x;
    const toY = ((1 - clip(1) / w) / 2) * size.height - place.y;
    if (isSeen && isBefore && kinds[n] !== 'placed') {
      const [armX, armY] = [toX - fromX, toY - fromY];
      const length2 = armX * armX + armY * armY;
      const part = length2 === 0 ? 0 : -(fromX * armX + fromY * armY) / length2;
      const along = Math.min(1, Math.max(0, part));
      const distance2 = (fromX + along * armX) ** 2 + (fromY + along * armY) ** 2;
      if (distance2 <= least) {
        least = distance2;
        best = n;
      }
    }
    [fromX, fromY, isBefore] = [toX, toY, isSeen];
  }
  return best;
}

/** The parts of the path for a drawing: two points each, with the attributes of each point. */
export interface PathSegments {
  positions: Float32Array;
  /** The number of the point to which the part leads. */
  places: Float32Array;
  /** Along the path's rapid moves, mm; -1: a part at feed. */
  rapids: Float32Array;
}

export function segmentsOf({ points, kinds }: ProgramPath): PathSegments {
  const count = kinds.reduce((sum, kind, n) => sum + (n > 0 && kind !== 'placed' ? 1 : 0), 0);
  const positions = new Float32Array(6 * count);
  const places = new Float32Array(2 * count);
  const rapids = new Float32Array(2 * count);
  let at = 0;
  let along = 0;
  for (let n = 1; n < kinds.length; n += 1) {
    if (kinds[n] === 'placed') continue;
    positions.set(points.subarray(3 * n - 3, 3 * n + 3), 6 * at);
    places.fill(n, 2 * at, 2 * at + 2);
    const length = Math.hypot(...[0, 1, 2].map((k) => points[3 * n + k]! - points[3 * n - 3 + k]!));
    if (kinds[n] === 'rapid') {
      rapids.set([along, along + length], 2 * at);
      along += length;
    } else {
      rapids.fill(-1, 2 * at, 2 * at + 2);
    }
    at += 1;
  }
  return { positions, places, rapids };
}
