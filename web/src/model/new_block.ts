// SPDX-License-Identifier: Apache-2.0
// Scenes of new blocks: from a template, around a mesh, or for a program; what they cost, in words.

import { language, t } from '../strings';
import type { Vec3 } from '../wire/types';
import { placementJson } from './placement';
import type { Placement } from './placement';

/** A scene as server/formats/README.md describes it. */
export type Scene = Record<string, unknown>;

/** Greatest surface errors to choose from, mm, from coarse to fine. */
export const TARGETS_MM: readonly number[] = [1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
export const TARGET_DEFAULT_MM = 0.1;

export interface Box {
  min: Vec3;
  max: Vec3;
}

export interface ToolChoice {
  id: number;
  shape: 'flat' | 'ball' | 'bull_nose';
  diameterMm: number;
  /** Of a bull nose. */
  cornerMm: number;
}

/** What the server says of a program: POST /v1/programs. */
export interface ProgramFacts {
  kinematics: string;
  tools: number[];
  feedMm: Box | null;
  motions: number;
  programmedS: number;
  /** On a machine whose axes accelerate. */
  machineS: number;
}

/** What a scene would cost: POST /v1/sessions?dry_run=1. */
export interface Price {
  /** Of a block that is touched everywhere. */
  bytes: number;
  /** Of a motion of 1 mm. */
  usPerMotion: number;
  /** Until the server has meshed such a block for the first page that joins. */
  joinS: number;
}

const TOOL_DEFAULT_MM = 6;
const LENGTH_DIAMETERS = 5;
/** Stock below the deepest cut, and the step to which the sides of a box are rounded. */
const FLOOR_MM = 2;
const ROUND_MM = 1;
const FORCE = { law: 'specific_energy', specific_force_n_per_mm2: 0.05, pivot_mm: 20 };
const HAND_TOOLS: readonly ToolChoice[] = [12, 6, 3].map((diameterMm, n) => ({
  id: n + 1,
  shape: 'ball',
  diameterMm,
  cornerMm: 0,
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

function toolJson({ id, shape, diameterMm, cornerMm }: ToolChoice): Scene {
  const length = Math.max(20, LENGTH_DIAMETERS * diameterMm);
  const corner = shape === 'bull_nose' ? { corner_radius_mm: cornerMm } : {};
  return { id, shape, diameter_mm: diameterMm, ...corner, length_mm: length };
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
    tools: HAND_TOOLS.map(toolJson),
    force: FORCE,
    machine: { kinematics: 'tool-vector' },
  };
}

/** A scene for a program. */
export function programScene(box: Box, tools: readonly ToolChoice[], kinematics: string): Scene {
  return {
    stock: { shape: 'box', min_mm: box.min, max_mm: box.max },
    tools: tools.map(toolJson),
    force: FORCE,
    machine: { kinematics },
  };
}

/**
 * A stock in which every cut of a program lies: the box of its feeds, wider by the largest tool's
 * radius, rounded outward to whole mm. Its top is Z 0 where all feeds lie below, as in most programs.
 */
export function stockFor(feed: Box | null, tools: readonly ToolChoice[]): Box {
  if (feed === null) return { min: [-50, -50, -20], max: [50, 50, 0] };
  const radius = Math.max(0, ...tools.map((tool) => tool.diameterMm / 2));
  const down = (value: number): number => Math.floor(value / ROUND_MM + 1e-9) * ROUND_MM + 0;
  const up = (value: number): number => Math.ceil(value / ROUND_MM - 1e-9) * ROUND_MM + 0;
  const bottom = down(feed.min[2] - FLOOR_MM);
  const top = feed.max[2] <= 0 ? 0 : up(feed.max[2]);
  return {
    min: [down(feed.min[0] - radius), down(feed.min[1] - radius), bottom],
    max: [up(feed.max[0] + radius), up(feed.max[1] + radius), Math.max(top, bottom + ROUND_MM)],
  };
}

function shapeIn(comment: string): ToolChoice['shape'] | null {
  if (/bull|torus|radius(ed)?\s+mill/i.test(comment)) return 'bull_nose';
  if (/ball/i.test(comment)) return 'ball';
  return /flat|end\s*mill|square/i.test(comment) ? 'flat' : null;
}

const MM_PER_INCH = 25.4;
// A size in inches may be a fraction or a mixed number: 1/2, 1-1/4, 1 1/4.
const NUMBER = String.raw`((?:\d+[ -])?\d+/[1-9]\d*|\d+\.?\d*|\.\d+)`;
const UNIT = String.raw`(?:\s*(MM|INCH(?:ES)?|IN|")(?![A-Z]))`;
const DIAMETER = new RegExp(String.raw`\bD(?:IA(?:METER)?)?\s*[=:]?\s*${NUMBER}${UNIT}?`, 'i');
const SIZE = new RegExp(NUMBER + UNIT, 'i');
const CORNER = new RegExp(String.raw`\bCR?\s*=\s*${NUMBER}${UNIT}?`, 'i');

function valueOf(number: string): number {
  const fraction = /^(?:(\d+)[ -])?(\d+)\/(\d+)$/.exec(number);
  if (!fraction) return Number(number);
  return Number(fraction[1] ?? 0) + Number(fraction[2]) / Number(fraction[3]);
}

/** The length, mm, that a pattern has found: in the unit behind it, or in that of the program. */
function lengthMm(found: RegExpExecArray, programUnitMm: number): number {
  const unit = found[2];
  const unitMm = unit === undefined ? programUnitMm : /mm/i.test(unit) ? 1 : MM_PER_INCH;
  return Number((valueOf(found[1]!) * unitMm).toFixed(6));
}

/** The unit of a program, mm: inches after G20 or UNITS/INCHES, whichever unit comes first. */
export function unitOf(text: string): number {
  const words = text.replace(/\([^)\r\n]*\)|;.*/g, ' ');
  const first = /(?<![A-Z])G0*2([01])(?![\d.])|\bUNITS\s*\/\s*(INCH|MM)/i.exec(words);
  return first?.[1] === '0' || first?.[2]?.toUpperCase() === 'INCH' ? MM_PER_INCH : 1;
}

/**
 * Tools as comments of post-processors describe them: "(T1 D=6. CR=0. - flat end mill)",
 * "(T2 3MM BALL NOSE)" or "(T3 0.25 IN END MILL)". Sizes without a unit have that of the program.
 */
export function toolsInComments(text: string): Map<number, Partial<ToolChoice>> {
  const programUnitMm = unitOf(text);
  const found = new Map<number, Partial<ToolChoice>>();
  for (const [, comment = ''] of text.matchAll(/[(;]\s*([^)\r\n]*)/g)) {
    const head = /^T(?:OOL)?\s*#?\s*(\d{1,6})\b[:\s=|-]*(.*)$/i.exec(comment);
    if (!head) continue;
    const id = Number(head[1]);
    const rest = head[2]!;
    const diameter = DIAMETER.exec(rest) ?? SIZE.exec(rest);
    const corner = CORNER.exec(rest);
    if (!diameter || found.has(id)) continue;
    const diameterMm = lengthMm(diameter, programUnitMm);
    const cornerMm = corner ? lengthMm(corner, programUnitMm) : 0;
    if (!(diameterMm > 0)) continue;
    let shape = shapeIn(rest) ?? 'flat';
    if (cornerMm > 0) shape = cornerMm >= diameterMm / 2 - 1e-6 ? 'ball' : 'bull_nose';
    else if (shape === 'bull_nose') shape = 'flat';
    found.set(id, { shape, diameterMm, cornerMm });
  }
  return found;
}

/** The tools that a program uses, with the sizes that its comments state. */
export function toolsOf(facts: ProgramFacts, text: string): ToolChoice[] {
  const stated = toolsInComments(text);
  const ids = facts.tools.length > 0 ? facts.tools : [1];
  return ids.map((id) => ({
    id,
    shape: 'flat',
    diameterMm: TOOL_DEFAULT_MM,
    cornerMm: 0,
    ...stated.get(id),
  }));
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

/** "0.05 mm: 38 µs a motion; carved all over 120 MB, joins in 410 ms" */
export function priceText({ usPerMotion, bytes, joinS }: Price, targetMm: number): string {
  return t(
    '{0}: {1} a motion; carved all over {2}, joins in {3}',
    amount(targetMm, 'mm'),
    timeText(usPerMotion),
    bytesText(bytes),
    timeText(1e6 * joinS),
  );
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
