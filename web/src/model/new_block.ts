// SPDX-License-Identifier: Apache-2.0
// Scenes of new blocks: from a template, around a mesh, or for a program; their cost, in words.

import { language, t } from '../strings';
import type { Vec3 } from '../wire/types';
import type { Box } from './box';
import { placementJson } from './placement';
import type { Placement } from './placement';

/** A scene as server/formats/README.md describes it. */
export type Scene = Record<string, unknown>;

/** Greatest surface errors to choose from, mm, from coarse to fine. */
export const TARGETS_MM: readonly number[] = [1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
export const TARGET_DEFAULT_MM = 0.1;

/** Where a field of a derived scene comes from. */
export interface FieldOrigin {
  /** Of the scene if null. */
  tool: number | null;
  field: string;
  origin: 'stated' | 'derived' | 'assumed';
  /** "comment in line 3"; empty if assumed. */
  source: string;
}

/** The scene that the server derives for a program: POST /v1/programs. */
export interface DerivedScene {
  scene: Scene;
  provenance: FieldOrigin[];
  motions: number;
  programmedS: number;
  /** On a machine whose axes accelerate. */
  machineS: number;
}

/** The cost of a scene, POST /v1/sessions?dry_run=1, or of a program in it, POST /v1/prices. */
export interface Price {
  /** Of a block that is touched everywhere, or that the program has carved. */
  bytes: number;
  /** Of a motion of 1 mm, or of the program. */
  usPerMotion: number;
  /** Of the program; missing without one. */
  motions?: number;
  /** Until the server has meshed such a block for the first page that joins. */
  joinS: number;
}

const FORCE = { law: 'specific_energy', specific_force_n_per_mm2: 0.05, pivot_mm: 20 };
const HAND_TOOLS = [12, 6, 3].map((diameter, n) => ({
  id: n + 1,
  shape: 'ball',
  diameter_mm: diameter,
  length_mm: Math.max(20, 5 * diameter),
}));

/** The same scene with another name and accuracy; where rays are three fields, they stay so. */
export function adapted(scene: Scene, name: string, targetMm: number): Scene {
  const { rays } = (scene['accuracy'] ?? {}) as { rays?: unknown };
  const accuracy = { target_mm: targetMm, ...(rays === 'tri-dexel' ? { rays } : {}) };
  return { ...scene, name, accuracy };
}

/** The accuracy that a template asks for, as one of TARGETS_MM. */
export function targetOf(scene: Scene): number {
  const accuracy = (scene['accuracy'] ?? {}) as { target_mm?: unknown; pitch_mm?: unknown };
  const wanted = Number(accuracy.target_mm ?? accuracy.pitch_mm ?? TARGET_DEFAULT_MM);
  return TARGETS_MM.find((target) => target <= wanted * 1.001) ?? TARGETS_MM.at(-1)!;
}

/** Whether the format of a model states no unit. */
export function lacksUnit(name: string): boolean {
  return !/\.(3mf|glb)$/i.test(name);
}

/** A scene whose stock is an uploaded mesh, to be carved by hand. */
export function meshScene(file: string, repaired: boolean, placement: Placement): Scene {
  const repair = repaired ? { repair: true } : {};
  const placed = placementJson(placement);
  return {
    stock: { shape: 'mesh', file, ...repair, ...(placed ? { placement: placed } : {}) },
    tools: HAND_TOOLS,
    force: FORCE,
    machine: { kinematics: 'tool-vector' },
  };
}

/** The scene of a program with another stock. */
export function withStock(scene: Scene, box: Box): Scene {
  return { ...scene, stock: { shape: 'box', min_mm: box.min, max_mm: box.max } };
}

/** The corners of a scene's stock, if it is a box. */
export function stockBox(scene: Scene): Box | null {
  const { min_mm: min, max_mm: max } = (scene['stock'] ?? {}) as Record<string, unknown>;
  if (!Array.isArray(min) || !Array.isArray(max)) return null;
  return { min: min.map(Number) as Vec3, max: max.map(Number) as Vec3 };
}

const DIGITS = new Intl.NumberFormat(language, { maximumSignificantDigits: 2 });
const TENTHS = new Intl.NumberFormat(language, { maximumFractionDigits: 1 });

/** With two digits: 999.6 µs are 1 ms. */
function rounded(value: number): number {
  return Number(value.toPrecision(2));
}

/** A number and its unit, which stay on one line. */
function amount(value: number, unit: string): string {
  return `${DIGITS.format(value)}\u00a0${unit}`;
}

/** 38 → "38 µs", 3007 → "3 ms" */
export function timeText(microseconds: number): string {
  const shown = rounded(microseconds);
  if (shown < 1000) return amount(shown, 'µs');
  return shown < 1e6 ? amount(shown / 1000, 'ms') : amount(shown / 1e6, 's');
}

/** 120e6 → "120 MB" */
export function bytesText(bytes: number): string {
  const units = ['B', 'kB', 'MB', 'GB', 'TB'];
  const shown = rounded(bytes);
  const step = Math.min(units.length - 1, Math.max(0, Math.floor(Math.log10(shown || 1) / 3)));
  return amount(shown / 1000 ** step, units[step]!);
}

/**
 * "0.05 mm: up to 120 MB of memory, 410 ms to join"; of a program
 * "0.05 mm: up to 90 MB of memory, 14 s to carve, 410 ms to join"
 */
export function priceText({ bytes, usPerMotion, motions, joinS }: Price, targetMm: number): string {
  const [target, memory] = [amount(targetMm, 'mm'), bytesText(bytes)];
  const join = timeText(1e6 * joinS);
  if (motions === undefined)
    return t('{0}: up to {1} of memory, {2} to join', target, memory, join);
  const carve = timeText(usPerMotion * motions);
  return t('{0}: up to {1} of memory, {2} to carve, {3} to join', target, memory, carve, join);
}

/** "38 µs per motion" */
export function motionPriceText({ usPerMotion }: Price): string {
  return t('{0} per motion', timeText(usPerMotion));
}

/** "120 × 80 × 20 mm", or "⌀ 60 × 80 mm" of a cylinder; empty if the stock is neither. */
export function stockText(stock: unknown): string {
  const from = (stock ?? {}) as Record<string, unknown>;
  const side = (value: number): string => TENTHS.format(value);
  if (typeof from['radius_mm'] === 'number') {
    const height = Number(from['max_z_mm']) - Number(from['min_z_mm']);
    return `⌀ ${side(2 * from['radius_mm'])} × ${side(height)} mm`;
  }
  const { min_mm: min, max_mm: max } = from;
  if (!Array.isArray(min) || !Array.isArray(max)) return '';
  return `${[0, 1, 2].map((n) => side(Number(max[n]) - Number(min[n]))).join(' × ')} mm`;
}

/** "Bracket, op 1" → "bracket-op-1": a session's id, not one of `taken`. */
export function freeId(name: string, taken: readonly string[]): string {
  const plain = name
    .normalize('NFKD')
    .replace(/\p{M}/gu, '')
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, '-')
    .replace(/^-+|-+$/g, '')
    .slice(0, 56);
  const base = plain === '' ? 'block' : plain;
  let id = base;
  for (let n = 2; taken.includes(id); n += 1) id = `${base}-${n}`;
  return id;
}

/** "Relief", or "Relief 2" if that is one of `taken`, in any case. */
export function freeName(name: string, taken: readonly string[]): string {
  const known = new Set(taken.map((one) => one.trim().toLocaleLowerCase()));
  let free = name;
  for (let n = 2; known.has(free.toLocaleLowerCase()); n += 1) free = `${name} ${n}`;
  return free;
}

/** How long ago a time is, from now on: "just now", "5 min ago", "3 days ago". */
export function ageText(timeMs: number, nowMs: number): string {
  const minutes = Math.floor((nowMs - timeMs) / 60_000);
  if (minutes < 1) return t('just now');
  if (minutes < 60) return t('{0} min ago', minutes);
  const hours = Math.floor(minutes / 60);
  if (hours < 24) return t('{0} h ago', hours);
  const days = Math.floor(hours / 24);
  return days === 1 ? t('a day ago') : t('{0} days ago', days);
}
