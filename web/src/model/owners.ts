// SPDX-License-Identifier: Apache-2.0
// Who cut which triangle of a surface. A triangle is asked about at its middle, with its own normal:
// at a corner several cuts meet.

import type { Triangles } from './refine';

/** Triangles with a value at each corner. */
export interface Valued extends Triangles {
  values: Float32Array<ArrayBuffer>;
}

/** Middle and unit normal of each triangle, six numbers; a normal of length 0 where it has no area. */
export function middlesOf({ positions: p, index }: Triangles): Float32Array<ArrayBuffer> {
  const middles = new Float32Array(2 * index.length);
  for (let n = 0; n < index.length; n += 3) {
    const [a, b, c] = [3 * index[n]!, 3 * index[n + 1]!, 3 * index[n + 2]!];
    const normal = crossOf(p, a, b, c);
    const size = Math.hypot(...normal) || 1;
    for (let k = 0; k < 3; k += 1) {
      middles[2 * n + k] = (p[a + k]! + p[b + k]! + p[c + k]!) / 3;
      middles[2 * n + 3 + k] = normal[k]! / size;
    }
  }
  return middles;
}

/** Of the triangle with corners at these places of `p`; its length is twice the area. */
function crossOf(p: Float32Array, a: number, b: number, c: number): [number, number, number] {
  const [ux, uy, uz] = [p[b]! - p[a]!, p[b + 1]! - p[a + 1]!, p[b + 2]! - p[a + 2]!];
  const [vx, vy, vz] = [p[c]! - p[a]!, p[c + 1]! - p[a + 1]!, p[c + 2]! - p[a + 2]!];
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}

/**
 * Triangles with corners of their own, because neighbors may have other owners.
 * @param isWanted which of them; the others are left out
 * @param valueOf of the triangle with this number
 */
export function apart(
  { positions, normals, index }: Triangles,
  isWanted: (n: number) => boolean,
  valueOf: (n: number) => number,
): Valued {
  const wanted: number[] = [];
  for (let n = 0; 3 * n < index.length; n += 1) if (isWanted(n)) wanted.push(n);
  const made: Valued = {
    positions: new Float32Array(9 * wanted.length),
    normals: new Float32Array(9 * wanted.length),
    index: Uint32Array.from({ length: 3 * wanted.length }, (_, n) => n),
    values: new Float32Array(3 * wanted.length),
  };
  wanted.forEach((n, at) => {
    made.values.fill(valueOf(n), 3 * at, 3 * at + 3);
    for (let corner = 0; corner < 3; corner += 1) {
      const from = 3 * index[3 * n + corner]!;
      const to = 9 * at + 3 * corner;
      made.positions.set(positions.subarray(from, from + 3), to);
      made.normals.set(normals.subarray(from, from + 3), to);
    }
  });
  return made;
}

/** Adds the areas of triangles to those of their values. */
export function addAreas({ positions, index, values }: Valued, areas: Map<number, number>): void {
  for (let n = 0; n < index.length; n += 3) {
    const [a, b, c] = [index[n]!, index[n + 1]!, index[n + 2]!];
    const area = Math.hypot(...crossOf(positions, 3 * a, 3 * b, 3 * c)) / 2;
    areas.set(values[a]!, (areas.get(values[a]!) ?? 0) + area);
  }
}

type Rgb = [number, number, number];
/** Distinct also for those who see no difference between red and green (after Okabe and Ito). */
const CLEAR = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#f0e442'];
/** Of 441 from black to white. */
const LEAST_DISTANCE = 70;

function rgbOf(color: string): Rgb {
  const value = parseInt(color.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}

function distanceOf(a: string, b: string): number {
  const [one, other] = [rgbOf(a), rgbOf(b)];
  return Math.hypot(...one.map((value, n) => value - other[n]!));
}

/** A color for one more: its own one, or one that is farther from those that are taken. */
export function distinctFrom(own: string, taken: readonly string[]): string {
  const farness = (color: string): number =>
    Math.min(Infinity, ...taken.map((other) => distanceOf(color, other)));
  if (farness(own) >= LEAST_DISTANCE) return own;
  return [own, ...CLEAR].reduce((best, color) => (farness(color) > farness(best) ? color : best));
}
