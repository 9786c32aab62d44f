// SPDX-License-Identifier: Apache-2.0
// Outlines of free profiles, APT cutters, shanks and holders as points (r, z), lengths in mm. The
// server has validated them (kernel/tool).

import type { ProfileStep, ToolInfo } from '../wire/types';

export type OutlinePoint = [r: number, z: number];

const ARC_STEPS = 16;

export function arc(
  centerR: number,
  centerZ: number,
  radius: number,
  from: number,
  to: number,
): OutlinePoint[] {
  const points: OutlinePoint[] = [];
  for (let i = 0; i <= ARC_STEPS; ++i) {
    const angle = from + ((to - from) * i) / ARC_STEPS;
    points.push([
      Math.max(0, centerR + radius * Math.cos(angle)),
      centerZ + radius * Math.sin(angle),
    ]);
  }
  return points;
}

/** Returns the arc from one point to another about a center, the shorter of the two. */
function arcBetween(from: OutlinePoint, to: OutlinePoint, center: OutlinePoint): OutlinePoint[] {
  const angleOf = ([r, z]: OutlinePoint): number => Math.atan2(z - center[1], r - center[0]);
  const start = angleOf(from);
  let turn = angleOf(to) - start;
  if (turn > Math.PI) turn -= 2 * Math.PI;
  if (turn < -Math.PI) turn += 2 * Math.PI;
  const points = arc(
    center[0],
    center[1],
    Math.hypot(from[0] - center[0], from[1] - center[1]),
    start,
    start + turn,
  );
  points[0] = from;
  points[points.length - 1] = to;
  return points;
}

function centerOf(from: OutlinePoint, step: Exclude<ProfileStep, readonly number[]>): OutlinePoint {
  if (step.center) return [...step.center];
  const [r, z] = step.to;
  const dr = r - from[0];
  const dz = z - from[1];
  const chord = Math.hypot(dr, dz);
  const off = Math.sqrt(Math.max(0, (step.radius ?? 0) ** 2 - chord ** 2 / 4)) / chord;
  const side = step.bulge === 'in' ? -1 : 1; // 'out': the arc bulges away from the axis
  return [(from[0] + r) / 2 - side * off * dz, (from[1] + z) / 2 + side * off * dr];
}

/** Returns a profile as one outline per step, shifted up by `base`. */
export function profileOutline(steps: readonly ProfileStep[], base = 0): OutlinePoint[][] {
  const pieces: OutlinePoint[][] = [];
  let at: OutlinePoint = [0, 0];
  for (const step of steps) {
    const to: OutlinePoint = 'to' in step ? [...step.to] : [step[0], step[1]];
    if (Math.hypot(to[0] - at[0], to[1] - at[1]) > 1e-9) {
      pieces.push('to' in step ? arcBetween(at, to, centerOf(at, step)) : [at, to]);
    }
    at = to;
  }
  return pieces.map((piece) => piece.map(([r, z]) => [r, z + base]));
}

/**
 * Returns the first or second intersection of the line from `p` along the unit vector `d` with a
 * circle (the nearest point if it misses).
 */
function intersectCircle(
  p: OutlinePoint,
  d: OutlinePoint,
  center: OutlinePoint,
  radius: number,
  second: boolean,
): OutlinePoint {
  const r = center[0] - p[0];
  const z = center[1] - p[1];
  const foot = r * d[0] + z * d[1];
  const half = Math.sqrt(Math.max(0, radius ** 2 - (d[0] * z - d[1] * r) ** 2));
  const t = second ? foot + half : foot - half;
  return [p[0] + t * d[0], p[1] + t * d[1]];
}

/** Returns the outline of the cutter that APT describes by CUTTER/d,r,e,f,alpha,beta,h. */
export function aptOutline(tool: ToolInfo): OutlinePoint[][] {
  const { d_mm: d = 6, r_mm: radius = 0, e_mm: e = d / 2, f_mm: f = 0, h_mm: height = 40 } = tool;
  const alpha = ((tool.alpha_deg ?? 0) * Math.PI) / 180;
  const beta = ((tool.beta_deg ?? 0) * Math.PI) / 180;
  const corner: OutlinePoint = [d / 2, (d / 2) * Math.tan(alpha)];
  const pieces: OutlinePoint[][] = [];
  let top = corner;
  if (radius > 0) {
    const start = intersectCircle([0, 0], [Math.cos(alpha), Math.sin(alpha)], [e, f], radius, true);
    top = intersectCircle(corner, [Math.sin(beta), Math.cos(beta)], [e, f], radius, false);
    if (top[1] > height)
      top = [e + Math.sqrt(Math.max(0, radius ** 2 - (height - f) ** 2)), height];
    if (Math.hypot(...start) > 1e-9) pieces.push([[0, 0], start]);
    pieces.push(arcBetween(start, top, [e, f]));
  } else {
    pieces.push([[0, 0], corner]);
  }
  if (top[1] < height)
    pieces.push([top, [Math.max(0, corner[0] + (height - corner[1]) * Math.tan(beta)), height]]);
  return pieces;
}

function cylinder(r0: number, r1: number, z0: number, z1: number): OutlinePoint[][] {
  return [
    [
      [0, z0],
      [r0, z0],
    ],
    [
      [r0, z0],
      [r1, z1],
    ],
    [
      [r1, z1],
      [0, z1],
    ],
  ];
}

export interface BodyOutline {
  pieces: OutlinePoint[][];
  /** Height of the upper end above the tip, mm. */
  topMm: number;
}

/** Returns the outlines of shank and holder above the cutting length. */
export function bodyOutline(tool: ToolInfo, cuttingLengthMm: number): BodyOutline {
  const pieces: OutlinePoint[][] = [];
  let top = cuttingLengthMm;
  const stack = (r0: number, r1: number, length: number): void => {
    pieces.push(...cylinder(r0, r1, top, top + length));
    top += length;
  };
  if (tool.shank)
    stack(tool.shank.diameter_mm / 2, tool.shank.diameter_mm / 2, tool.shank.length_mm);
  if (Array.isArray(tool.holder)) {
    for (const {
      diameter_mm: lower,
      top_diameter_mm: upper = lower,
      length_mm: length,
    } of tool.holder) {
      stack(lower / 2, upper / 2, length);
    }
  } else if (tool.holder) {
    const drawn = profileOutline(tool.holder.profile_mm, top);
    const last = drawn.at(-1)?.at(-1);
    if (last) {
      pieces.push(...drawn, [last, [0, last[1]]]);
      top = last[1];
    }
  }
  return { pieces, topMm: top };
}
