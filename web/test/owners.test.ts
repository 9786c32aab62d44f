// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { addAreas, apart, middlesOf, distinctFrom } from '../src/model/owners';
import type { Triangles } from '../src/model/refine';

/** Two triangles that share an edge: one level, of 2 mm², one upright, of 3 mm². */
const BENT: Triangles = {
  positions: new Float32Array([0, 0, 1, 2, 0, 1, 0, 2, 1, 2, 0, -2]),
  normals: new Float32Array([0, 0, 1, 0, -1, 0, 0, 0, 1, 0, -1, 0]),
  index: new Uint32Array([0, 1, 2, 0, 3, 1]),
};

describe('the middle of a triangle', () => {
  it('is asked about with the normal of the triangle, not those of its corners', () => {
    const middles = middlesOf(BENT);
    expect([...middles.subarray(0, 6)].map((v) => Number(v.toFixed(4)))).toEqual([
      0.6667, 0.6667, 1, 0, 0, 1,
    ]);
    expect([...middles.subarray(6)].map((v) => Number(v.toFixed(4)) + 0)).toEqual([
      1.3333, 0, 0, 0, -1, 0,
    ]);
  });

  it('has no normal where the triangle has no area', () => {
    const flat = { ...BENT, index: new Uint32Array([0, 1, 1]) };
    expect([...middlesOf(flat).subarray(3)]).toEqual([0, 0, 0]);
  });
});

describe('triangles with corners of their own', () => {
  it('have one value at all corners, without the unwanted triangles', () => {
    const made = apart(
      BENT,
      (n) => n === 1,
      (n) => 10 + n,
    );
    expect([...made.values]).toEqual([11, 11, 11]);
    expect([...made.index]).toEqual([0, 1, 2]);
    expect([...made.positions]).toEqual([0, 0, 1, 2, 0, -2, 2, 0, 1]);
    expect([...made.normals]).toEqual([0, 0, 1, 0, -1, 0, 0, -1, 0]);
  });

  it('have areas that add up by value', () => {
    const areas = new Map([[7, 1]]);
    const made = apart(
      BENT,
      () => true,
      (n) => (n === 0 ? 7 : 8),
    );
    addAreas(made, areas);
    expect(areas.get(7)).toBeCloseTo(3);
    expect(areas.get(8)).toBeCloseTo(3);
  });
});

describe('distinct colors', () => {
  it('are those of the people where they differ', () => {
    expect(distinctFrom('#d9541e', [])).toBe('#d9541e');
    expect(distinctFrom('#0000ff', ['#ff0000'])).toBe('#0000ff');
  });

  it('differ where an earlier participant has nearly the same', () => {
    const taken: string[] = [];
    for (let n = 0; n < 6; n += 1) taken.push(distinctFrom('#d9541e', taken));
    expect(taken[0]).toBe('#d9541e');
    expect(new Set(taken).size).toBe(6);
    expect(distinctFrom('#d9541f', ['#d9541e'])).not.toBe('#d9541f');
  });

  it('are the farthest one when all are taken', () => {
    const taken: string[] = [];
    for (let n = 0; n < 20; n += 1) taken.push(distinctFrom('#d9541e', taken));
    expect(taken).toHaveLength(20);
    for (const color of taken) expect(color).toMatch(/^#[0-9a-f]{6}$/);
  });
});
