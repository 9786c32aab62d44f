// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import {
  cornersOf,
  feedAt,
  feedCurveOf,
  nearestInPicture,
  placeAt,
  pathOfAnswer,
  pointOf,
  pointsOfLine,
  reached,
  segmentsOf,
} from '../src/model/program_path';

/** A rapid to the first hole, two holes by the same lines of a subprogram, the tool placed again. */
const PATH = pathOfAnswer({
  points: 8,
  error_mm: 0.002,
  kind: 'srffrffs',
  x_mm: [0, 10, 10, 10, 30, 30, 30, 50],
  y_mm: [0, 0, 0, 0, 0, 0, 0, 0],
  z_mm: [5, 5, -4, 5, 5, -4, 5, 5],
  line: [1, 3, 20, 21, 5, 20, 21, 9],
  tool: [1, 1, 1, 1, 1, 1, 1, 1],
  time_s: [0, 1, 3, 4, 6, 8, 9, 9],
});

describe('the path of a program', () => {
  it('has a place and a line at every time', () => {
    const at = (timeS: number) => {
      const { point, tip } = placeAt(PATH, timeS)!;
      return [PATH.lines[point], ...tip];
    };
    expect(at(-1)).toEqual([1, 0, 0, 5]);
    expect(at(0.5)).toEqual([3, 5, 0, 5]);
    expect(at(2)).toEqual([20, 10, 0, 0.5]); // the first time through the subprogram
    expect(at(7)).toEqual([20, 30, 0, 0.5]); // the second
    expect(at(9)).toEqual([21, 30, 0, 5]);
    expect(at(99)).toEqual([9, 50, 0, 5]);
    expect(placeAt(pathOfAnswer({}), 1)).toBeNull();
  });

  it('has a feed of each of its parts, but for rapids', () => {
    const curve = feedCurveOf(PATH);
    expect(curve.timesS).toEqual([0, 1, 3, 4, 6, 8, 9]); // nothing moves when the tool is placed
    expect(curve.feeds).toEqual([null, null, 270, 540, null, 270, 540]);
    expect([0.5, 1, 2, 3.5, 5, 9, 9.1, -1].map((timeS) => feedAt(curve, timeS))).toEqual([
      null,
      null,
      270,
      540,
      null,
      540,
      null,
      null,
    ]);
    expect(feedCurveOf(pathOfAnswer({}))).toEqual({ timesS: [], feeds: [] });
  });

  it('has a feed that is plotted between two rapids, too', () => {
    const curve = { timesS: [0, 1, 3, 4], feeds: [null, null, 600, null] };
    expect(cornersOf(curve)).toEqual([
      [0, 1, 1, 3, 3, 4],
      [null, null, 600, 600, null, null],
    ]);
    expect(cornersOf({ timesS: [], feeds: [] })).toEqual([[], []]);
  });

  it('is read as the server writes it', () => {
    expect(PATH.lines).toHaveLength(8);
    expect(PATH.kinds.slice(0, 3)).toEqual(['placed', 'rapid', 'feed']);
    expect(pointOf(PATH, 2)).toEqual([10, 0, -4]);
    expect(PATH.errorMm).toBe(0.002);
    expect([...PATH.timesS]).toEqual([0, 1, 3, 4, 6, 8, 9, 9]);
    expect(pathOfAnswer({ x_mm: [1, 2], kind: 'sf' }).lines).toHaveLength(0);
    expect(pathOfAnswer(null).lines).toHaveLength(0);
  });

  it('has come to the point of the live line, the right time it occurs', () => {
    expect(reached(PATH, 3, 0.1)).toBe(1);
    expect(reached(PATH, 20, 0.3)).toBe(2);
    expect(reached(PATH, 20, 0.7)).toBe(5);
    expect(reached(PATH, 21, 1)).toBe(7);
    // A line whose point was left out: as far as the lines before it.
    expect(reached(PATH, 4, 0.4)).toBe(1);
  });

  it('knows where the tool is, however far the share of the motions is from the place', () => {
    const lines = [10, 11, 12, 13, 3, 4, 5, 14, 3, 4, 5, 15]; // 13 and 14 call a subprogram
    const zeros = lines.map(() => 0);
    const columns = { x_mm: zeros, y_mm: zeros, z_mm: zeros, kind: 'f'.repeat(lines.length) };
    const path = pathOfAnswer({ ...columns, line: lines });
    for (const share of [0, 0.005, 0.5, 0.99]) {
      expect(reached(path, 13, share)).toBe(3);
      expect(reached(path, 12, share)).toBe(2);
      expect(reached(path, 10, share)).toBe(0);
    }
    expect(reached(path, 4, 0.005)).toBe(5);
    expect(reached(path, 4, 0.99)).toBe(9);
    // Line 7, which has no points: the start, or the end of the subprogram.
    expect(reached(path, 7, 0.005)).toBe(0);
    expect(reached(path, 7, 0.5)).toBe(6);
    const sparse = pathOfAnswer({
      ...columns,
      line: lines.map((line) => (line === 12 ? 11 : line)),
    });
    expect(pointsOfLine(sparse, 12)).toEqual([2, 2]);
    expect(reached(sparse, 12, 0.005)).toBe(2);
    expect(pointsOfLine(path, 7)).toEqual([0, 0]);
    expect(pointsOfLine(path, 99)).toEqual([11, 11]);
  });

  it('has the points of a line, or the place before one that has none', () => {
    expect(pointsOfLine(PATH, 20)).toEqual([2, 2]);
    expect(pointsOfLine(PATH, 2)).toEqual([0, 0]);
    expect(pointsOfLine(pathOfAnswer({}), 2)).toBeNull();
    const arc = pathOfAnswer({
      ...{ kind: 'sfff', x_mm: [0, 1, 2, 3], y_mm: [0, 1, 1, 0], z_mm: [0, 0, 0, 0] },
      line: [1, 2, 2, 2],
    });
    expect(pointsOfLine(arc, 2)).toEqual([1, 3]);
  });

  it('is drawn part by part, without a line to where the tool is placed', () => {
    const { positions, places, rapids } = segmentsOf(PATH);
    expect(positions).toHaveLength(6 * 6);
    expect([...positions.slice(0, 6)]).toEqual([0, 0, 5, 10, 0, 5]);
    expect([...places]).toEqual([1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6]);
    // Dashes go on from one rapid to the next.
    expect([...rapids]).toEqual([0, 10, -1, -1, -1, -1, 10, 30, -1, -1, -1, -1]);
  });
});

describe('nearestInPicture', () => {
  // Looks along y: x to the right, z up, 1 mm a pixel in a picture of 100 × 100 around the origin.
  const matrix = [0.02, 0, 0, 0, 0, 0, 1, 0, 0, 0.02, 0, 0, 0, 0, 0, 1];
  const size = { width: 100, height: 100 };
  const near = (x: number, y: number, most = 4): number =>
    nearestInPicture(PATH, matrix, size, { x, y }, most);

  it('finds the part under a place', () => {
    expect(near(55, 46)).toBe(1); // the rapid at z 5
    expect(near(81, 50)).toBe(6); // of two on one another the later
    expect(near(70, 45)).toBe(4);
  });

  it('finds nothing far away, nor where the tool is only placed', () => {
    expect(near(55, 52)).toBe(-1);
    expect(near(95, 45)).toBe(-1);
    expect(near(50, 52, 8)).toBe(1);
  });

  it('leaves out points behind the camera', () => {
    const behind = matrix.map((value, n) => (n === 15 ? -1 : value));
    expect(nearestInPicture(PATH, behind, size, { x: 45, y: 54 }, 40)).toBe(-1);
  });
});
