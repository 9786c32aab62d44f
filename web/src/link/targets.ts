// SPDX-License-Identifier: Apache-2.0
// Requests about target parts: meshes that the block is compared with.

import type { DeviationSurvey } from '../model/deviation';
import type { Vec3 } from '../wire/types';
import { ask } from './server_error';
import { pathOf } from './address';

/** A mesh that the block is compared with. */
export interface TargetPart {
  /** The name of its file. */
  name: string;
  triangles: number;
  /** Bounds in the coordinates of the block. */
  min_mm: Vec3;
  max_mm: Vec3;
  /** Added to the coordinates of the file. */
  shift_mm: Vec3;
  /** Why it bounds no solid, so that signs are unreliable. */
  fault?: string;
}

/** An answer to the question about the unit of a part, as the query of setTarget has it. */
export interface UnitAnswer {
  unit?: string;
  /** A factor on the coordinates instead of a unit. */
  scale?: number;
  /** The greatest side with it, mm. */
  size_mm: number;
}

/** A stored part. */
export interface SentPart extends TargetPart {
  /** Asks for the unit of a file that states none, if the size is unlikely. */
  questions?: { text: string; choices: UnitAnswer[] }[];
}

/** Points of one request, at most. */
export const POINTS_MAX = 65_536;

function partPath(session: string, name: string, what: string): string {
  return pathOf(session, `targets/${encodeURIComponent(name)}${what}`);
}

/** All of these reject with a ServerError, or as fetch does when `signal` is aborted. */
export async function listTargets(session: string): Promise<TargetPart[]> {
  const response = await ask('GET', pathOf(session, 'targets'));
  const { targets } = (await response.json()) as { targets: TargetPart[] };
  return targets;
}

/** Stores a file; one of the same name is replaced. `as`: its unit; by default mm, or as stated. */
export async function setTarget(
  session: string,
  file: Blob & { name: string },
  [x, y, z]: Vec3,
  as?: UnitAnswer,
): Promise<SentPart> {
  const unit = as?.unit === undefined ? '' : `&unit=${as.unit}`;
  const scale = as?.scale === undefined ? '' : `&scale=${as.scale}`;
  const query = `?name=${encodeURIComponent(file.name)}&shift_mm=${x},${y},${z}${unit}${scale}`;
  const response = await ask('POST', pathOf(session, `targets${query}`), file);
  return (await response.json()) as SentPart;
}

export async function removeTarget(session: string, name: string): Promise<void> {
  await ask('DELETE', partPath(session, name, ''));
}

/** @param at a record of the past; null: the block as it is */
export async function surveyDeviation(
  session: string,
  name: string,
  at: number | null,
  signal: AbortSignal,
): Promise<DeviationSurvey> {
  const query = at === null ? '' : `?at=${at}`;
  const response = await ask('GET', partPath(session, name, `/deviation${query}`), null, signal);
  return (await response.json()) as DeviationSurvey;
}

/** The signed distances of points from the part, mm: X, Y and Z of each, at most POINTS_MAX. */
export async function distancesFrom(
  session: string,
  name: string,
  points: Float32Array<ArrayBuffer>,
  signal: AbortSignal,
): Promise<Float32Array> {
  const response = await ask('POST', partPath(session, name, '/distances'), points, signal);
  return new Float32Array(await response.arrayBuffer());
}
