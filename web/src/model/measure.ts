// SPDX-License-Identifier: Apache-2.0
// Measures between points of the surface, and their texts.

import { language } from '../strings';
import type { Vec3 } from '../wire/types';
import { cross, distance, dot, minus, plus, scaled, unitOf } from './vector';

export type MeasureKind = 'distance' | 'thickness' | 'depth' | 'radius' | 'angle';
export type LengthUnit = 'mm' | 'in';

/** How many points are pressed. */
export const POINTS_OF: Record<MeasureKind, number> = {
  distance: 2,
  thickness: 1,
  depth: 1,
  radius: 3,
  angle: 2,
};

export interface Measure {
  kind: MeasureKind;
  /** The length, mm; for an angle degrees. */
  value: number;
  /** The lines to draw, from point to point. */
  line: Vec3[];
  /** Where the figure stands. */
  place: Vec3;
  /** For a distance: along the axes, mm. */
  parts?: Vec3;
}

/** A point that was pressed. */
export interface Pressed {
  point: Vec3;
  /** Unit vector out of the material. */
  normal: Vec3;
}

const MM_PER_INCH = 25.4;

export interface Circle {
  center: Vec3;
  radius: number;
  normal: Vec3;
}

/** The circle through three points; null if they are on a line. */
export function circleThrough(a: Vec3, b: Vec3, c: Vec3): Circle | null {
  const [p, q] = [minus(b, a), minus(c, a)];
  const normal = cross(p, q);
  const size2 = dot(normal, normal);
  if (size2 <= 1e-12 * dot(p, p) * dot(q, q)) return null;
  const arm = cross(minus(scaled(q, dot(p, p)), scaled(p, dot(q, q))), normal);
  const center = plus(a, arm, 1 / (2 * size2));
  return { center, radius: distance(center, a), normal: unitOf(normal) };
}

/** The angle between two faces through the material, degrees: 90 at the edge of a box. */
export function faceAngle(a: Vec3, b: Vec3): number {
  const between = Math.atan2(Math.hypot(...cross(a, b)), dot(a, b));
  return 180 - (between * 180) / Math.PI;
}

function middle(a: Vec3, b: Vec3): Vec3 {
  return scaled(plus(a, b), 0.5);
}

export function distanceOf(a: Vec3, b: Vec3): Measure {
  const parts = minus(b, a).map(Math.abs) as Vec3;
  return { kind: 'distance', value: distance(a, b), line: [a, b], place: middle(a, b), parts };
}

export function thicknessOf(point: Vec3, end: Vec3): Measure {
  const line = [point, end];
  return { kind: 'thickness', value: distance(point, end), line, place: middle(point, end) };
}

/** Below the top of the stock. */
export function depthOf(point: Vec3, topMm: number): Measure {
  const top: Vec3 = [point[0], point[1], topMm];
  return { kind: 'depth', value: topMm - point[2], line: [point, top], place: middle(point, top) };
}

export function radiusOf(a: Vec3, b: Vec3, c: Vec3): Measure | null {
  const circle = circleThrough(a, b, c);
  if (!circle) return null;
  const { center, radius, normal } = circle;
  const u = unitOf(minus(a, center));
  const v = cross(normal, u);
  const line = Array.from({ length: 65 }, (_, n): Vec3 => {
    const angle = (n * Math.PI) / 32;
    return plus(plus(center, u, radius * Math.cos(angle)), v, radius * Math.sin(angle));
  });
  return { kind: 'radius', value: radius, line, place: center };
}

/** @param armMm length of the drawn normals */
export function angleOf(a: Pressed, b: Pressed, armMm: number): Measure {
  const line = [plus(a.point, a.normal, armMm), a.point, b.point, plus(b.point, b.normal, armMm)];
  const value = faceAngle(a.normal, b.normal);
  return { kind: 'angle', value, line, place: middle(a.point, b.point) };
}

function fixed(value: number, digits: number): string {
  return new Intl.NumberFormat(language, {
    minimumFractionDigits: digits,
    maximumFractionDigits: digits,
  }).format(Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value);
}

/** To a micrometer, or to a tenth of a thousandth of an inch. */
export function lengthText(mm: number, unit: LengthUnit): string {
  return unit === 'mm' ? `${fixed(mm, 3)} mm` : `${fixed(mm / MM_PER_INCH, 4)} in`;
}

export function areaText(mm2: number, unit: LengthUnit): string {
  return unit === 'mm' ? `${fixed(mm2, 2)} mm²` : `${fixed(mm2 / MM_PER_INCH ** 2, 4)} in²`;
}

/** A length in the unit in which it is typed. */
export function inUnit(mm: number, unit: LengthUnit): number {
  return unit === 'mm' ? mm : mm / MM_PER_INCH;
}

export function fromUnit(value: number, unit: LengthUnit): number {
  return unit === 'mm' ? value : value * MM_PER_INCH;
}

export function valueText({ kind, value }: Measure, unit: LengthUnit): string {
  if (kind === 'angle') return `${fixed(value, 2)}°`;
  const text = lengthText(value, unit);
  return kind === 'radius' ? `R ${text} · ⌀ ${lengthText(2 * value, unit)}` : text;
}

/** “Δx 1.000 · Δy 2.000 · Δz 0.000”; empty for a measure without parts. */
export function partsText({ parts }: Measure, unit: LengthUnit): string {
  if (!parts) return '';
  const digits = unit === 'mm' ? 3 : 4;
  return parts.map((mm, n) => `Δ${'xyz'[n]} ${fixed(inUnit(mm, unit), digits)}`).join(' · ');
}
