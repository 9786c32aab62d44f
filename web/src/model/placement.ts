// SPDX-License-Identifier: Apache-2.0
// Where the mesh of a file lies in a scene: its numbers times unit and scale, turned about the
// origin, then moved (server/formats/model/mesh_placement.h).

import type { Vec3 } from '../wire/types';
import type { Box } from './box';

/** Units of the numbers in a model, mm. */
export const UNITS_MM: Readonly<Record<string, number>> = { mm: 1, cm: 10, m: 1000, inch: 25.4 };

export interface Placement {
  unit: string;
  /** > 0, along all axes. */
  scale: number;
  /** About X, then Y, then Z. */
  rotateDeg: Vec3;
  translateMm: Vec3;
}

export function unplaced(): Placement {
  return { unit: 'mm', scale: 1, rotateDeg: [0, 0, 0], translateMm: [0, 0, 0] };
}

const isZero = (v: Vec3): boolean => v.every((value) => value === 0);

/** The scene's field `placement`, without unchanged parts; null if all are unchanged. */
export function placementJson(placement: Placement): Record<string, unknown> | null {
  const { unit, scale, rotateDeg, translateMm } = placement;
  const json = {
    ...(unit === 'mm' ? {} : { unit }),
    ...(scale === 1 ? {} : { scale: [scale, scale, scale] }),
    ...(isZero(rotateDeg) ? {} : { rotate_deg: rotateDeg }),
    ...(isZero(translateMm) ? {} : { translate_mm: translateMm }),
  };
  return Object.keys(json).length === 0 ? null : json;
}

/** Exact for quarter turns. */
function turned(first: number, second: number, deg: number): [number, number] {
  const quarters = Math.round(deg / 90);
  const rest = ((deg - 90 * quarters) * Math.PI) / 180;
  const [c, s] = [Math.cos(rest), Math.sin(rest)];
  let [a, b] = [c * first - s * second, s * first + c * second];
  for (let n = ((quarters % 4) + 4) % 4; n > 0; --n) [a, b] = [-b, a];
  return [a, b];
}

function placed([x, y, z]: Vec3, { unit, scale, rotateDeg, translateMm }: Placement): Vec3 {
  const factor = UNITS_MM[unit]! * scale;
  let [px, py, pz] = [x * factor, y * factor, z * factor];
  [py, pz] = turned(py, pz, rotateDeg[0]);
  [pz, px] = turned(pz, px, rotateDeg[1]);
  [px, py] = turned(px, py, rotateDeg[2]);
  return [px + translateMm[0], py + translateMm[1], pz + translateMm[2]];
}

/**
 * The box around a box of the file that is placed: around the mesh exactly for quarter turns, else
 * the mesh may be smaller.
 */
export function placedBox({ min, max }: Box, placement: Placement): Box {
  const ends = [min, max];
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) =>
    placed([ends[n & 1]![0], ends[(n >> 1) & 1]![1], ends[(n >> 2) & 1]![2]], placement),
  );
  const along = (pick: (...values: number[]) => number): Vec3 =>
    [0, 1, 2].map((axis) => pick(...corners.map((corner) => corner[axis]!)) + 0) as Vec3;
  return { min: along(Math.min), max: along(Math.max) };
}

/** Whether the box around it is that of the mesh. */
export function isRight({ rotateDeg }: Placement): boolean {
  return rotateDeg.every((deg) => deg % 90 === 0);
}
