// SPDX-License-Identifier: Apache-2.0
// Requests the surface at a point, and who cut it.

import type { Vec3 } from '../wire/types';
import { pathOf } from './address';
import { ask } from './strokes';

/** The motion that was the first to cut a place. */
export interface Cut {
  record: number;
  participant: number;
  tool: number;
  /** Of which the motion is a part: number of its first record, and when it began, ms since 1970. */
  stroke: number;
  beginMs: number;
  /** The program that moved the tool, if it did and is still listed; `line` 0: unknown. */
  program: { id: number; name: string; line: number } | null;
}

export interface Probe {
  /** To a quantum; null: on a wall along the rays, or no longer there. */
  atMm: Vec3 | null;
  quantumMm: number;
  /** null: the surface of the stock as it was */
  cut: Cut | null;
}

type Json = Record<string, unknown>;

function isObject(value: unknown): value is Json {
  return typeof value === 'object' && value !== null;
}

function numberIn(from: Json, name: string): number {
  const value = from[name];
  return typeof value === 'number' && Number.isFinite(value) ? value : 0;
}

function cutOf(value: unknown): Cut | null {
  if (!isObject(value)) return null;
  const { program } = value;
  return {
    record: numberIn(value, 'record'),
    participant: numberIn(value, 'participant'),
    tool: numberIn(value, 'tool'),
    stroke: numberIn(value, 'stroke'),
    beginMs: numberIn(value, 'begin_ms'),
    program: isObject(program)
      ? {
          id: numberIn(program, 'id'),
          name: typeof program['name'] === 'string' ? program['name'] : '',
          line: numberIn(program, 'line'),
        }
      : null,
  };
}

/** Reads the answer of the server. */
export function probeOf(value: unknown): Probe {
  const answer = isObject(value) ? value : {};
  const surface = isObject(answer['surface']) ? answer['surface'] : null;
  const at = surface?.['at_mm'];
  const isPlace = Array.isArray(at) && at.length === 3 && at.every(Number.isFinite);
  return {
    atMm: isPlace ? (at as Vec3) : null,
    quantumMm: surface ? numberIn(surface, 'quantum_mm') : 0,
    cut: cutOf(answer['cut']),
  };
}

/**
 * Asks about a point of the displayed surface.
 * @param record after which the block is looked at; null: as it is
 */
export async function probe(
  session: string,
  point: Vec3,
  normal: Vec3,
  record: number | null,
): Promise<Probe> {
  const at = record === null ? '' : `&at=${record}`;
  const query = `probe?at_mm=${point.join()}&normal=${normal.join()}${at}`;
  return probeOf(await ask(pathOf(session, query), 'GET'));
}
