// SPDX-License-Identifier: Apache-2.0
// Symmetry of strokes: planes through the middle of the block, or turns about its vertical axis.

import { stockBounds } from '../model/session';
import type { Vec3, Welcome } from '../wire/types';
import type { Image } from './tool/path_queue';

/** A plane across this axis; a number: so many strokes around the vertical axis. */
export type Mirror = 'off' | 'x' | 'y' | 'z' | number;
export const TURNS: readonly number[] = Array.from({ length: 11 }, (_, n) => n + 2);

/**
 * The middle of the block, moved by less than a quarter of the pitch so that a mirror there maps
 * columns to columns: their places are (n + 1/2) pitches from the block's minimum corner.
 */
export function middleOf({ stock, pitch_mm }: Pick<Welcome, 'stock' | 'pitch_mm'>): Vec3 {
  const { min, max } = stockBounds(stock);
  const half = pitch_mm / 2;
  return min.map((from, n) => from + half * Math.round((max[n]! - from) / 2 / half)) as Vec3;
}

function reflected(axis: 0 | 1 | 2, middle: Vec3): Image {
  return ({ tip, axis: direction }) => ({
    tip: tip.map((value, n) => (n === axis ? 2 * middle[axis] - value : value)) as Vec3,
    axis: direction.map((value, n) => (n === axis ? -value : value)) as Vec3,
  });
}

function turned(angle: number, [x, y]: Vec3): Image {
  // Quarters are exact.
  const [c, s] = [Math.cos(angle), Math.sin(angle)].map((one) => Number(one.toFixed(15))) as [
    number,
    number,
  ];
  const around = ([u, v, w]: Vec3): Vec3 => [c * u - s * v, s * u + c * v, w];
  return ({ tip, axis }) => {
    const [u, v, w] = around([tip[0] - x, tip[1] - y, tip[2]]);
    return { tip: [u + x, v + y, w], axis: around(axis) };
  };
}

/** The images of a stroke, without the stroke itself. */
export function imagesOf(mirror: Mirror, middle: Vec3): Image[] {
  if (mirror === 'off') return [];
  if (typeof mirror === 'number')
    return Array.from({ length: mirror - 1 }, (_, n) =>
      turned((2 * Math.PI * (n + 1)) / mirror, middle),
    );
  return [reflected({ x: 0 as const, y: 1 as const, z: 2 as const }[mirror], middle)];
}

/** The choice after another one: off, the planes, and as many turns as were chosen last. */
export function nextMirror(mirror: Mirror, turns: number): Mirror {
  if (typeof mirror === 'number') return 'off';
  return ({ off: 'x', x: 'y', y: 'z', z: turns } as const)[mirror];
}
