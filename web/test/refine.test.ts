// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { refined } from '../src/model/refine';
import type { Triangles } from '../src/model/refine';

function trianglesOf(positions: number[], index: number[]): Triangles {
  return {
    positions: Float32Array.from(positions),
    normals: Float32Array.from(positions, (_, n) => (n % 3 === 2 ? 1 : 0)),
    index: Uint32Array.from(index),
  };
}

type Point = [number, number, number];

function pointOf({ positions }: Triangles, corner: number): Point {
  return [positions[3 * corner]!, positions[3 * corner + 1]!, positions[3 * corner + 2]!];
}

/** Each edge with the number of triangles that have it in this direction. */
function edgesOf(triangles: Triangles): Map<string, number> {
  const edges = new Map<string, number>();
  const { index } = triangles;
  for (let n = 0; n < index.length; n += 3)
    for (const [a, b] of [
      [0, 1],
      [1, 2],
      [2, 0],
    ] as const) {
      const key = [index[n + a]!, index[n + b]!]
        .map((corner) => pointOf(triangles, corner).join(' '))
        .join(' to ');
      edges.set(key, (edges.get(key) ?? 0) + 1);
    }
  return edges;
}

function endsOf(edge: string): [Point, Point] {
  return edge.split(' to ').map((text) => text.split(' ').map(Number)) as [Point, Point];
}

function areaOf(triangles: Triangles): number {
  let area = 0;
  const { index } = triangles;
  for (let n = 0; n < index.length; n += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => pointOf(triangles, index[n + k]!)) as [
      Point,
      Point,
      Point,
    ];
    area += ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2;
  }
  return area;
}

/** A flat plate of slivers and large triangles that share edges. */
const PLATE = trianglesOf(
  [0, 0, 0, 10, 0, 0, 10, 7, 0, 0, 7, 0, 0.3, 3, 0, 9, 6.9, 0],
  [0, 1, 4, 1, 2, 5, 1, 5, 4, 2, 3, 5, 5, 3, 4, 3, 0, 4],
);

describe('divided triangles', () => {
  it('have no edge above the limit and the same area, none turned over', () => {
    for (const limit of [4, 1]) {
      const fine = refined(PLATE, limit);
      expect(areaOf(fine)).toBeCloseTo(70, 3);
      const edges = edgesOf(fine);
      expect(Math.max(...edges.values())).toBe(1);
      const lengths = [...edges.keys()].map((edge) => {
        const [a, b] = endsOf(edge);
        return Math.hypot(a[0] - b[0], a[1] - b[1]);
      });
      expect(Math.max(...lengths)).toBeLessThanOrEqual(limit * 1.0001);
    }
  });

  it('meet along their edges', () => {
    const edges = edgesOf(refined(PLATE, 0.7));
    let border = 0;
    for (const edge of edges.keys()) {
      const [from, to] = edge.split(' to ') as [string, string];
      if (edges.has(`${to} to ${from}`)) continue;
      const [a, b] = endsOf(edge);
      border += Math.hypot(a[0] - b[0], a[1] - b[1]);
    }
    expect(border).toBeCloseTo(34, 3); // only the border of the plate is open
  });

  it('stay as they are where they are small', () => {
    const same = refined(PLATE, 20);
    expect([...same.index]).toEqual([...PLATE.index]);
    expect([...same.positions]).toEqual([...PLATE.positions]);
  });

  it('end after eight halvings', () => {
    const fine = refined(trianglesOf([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]), 1e-9);
    expect(fine.index.length / 3).toBe(4 ** 8);
  });
});
