// SPDX-License-Identifier: Apache-2.0
// The outline of a tool while it is edited: points from the tip up, and how each is reached from the
// one before. Whether it is a tool is for the server and the kernel to say.

import type { ProfileStep, ToolInfo } from '../wire/types';

/**
 * The edge that leads to a point: a straight line, or an arc away from the axis or towards it (a
 * fillet).
 */
export type Edge = 'line' | 'out' | 'in';

/** Lengths in mm. */
export interface ProfilePoint {
  r: number;
  z: number;
  edge: Edge;
  /** Of an arc; 0 of a line. */
  radius: number;
}

const STEP_MM = 0.1;
const NEW_TOOL_MM = { diameter: 6, length: 30 };

function line(r: number, z: number): ProfilePoint {
  return { r, z, edge: 'line', radius: 0 };
}

function arc(r: number, z: number, radius: number): ProfilePoint {
  return { r, z, edge: 'out', radius };
}

/** The nearest place of a pointer's grid. */
export function snapped(valueMm: number): number {
  return Math.round(valueMm / STEP_MM) / (1 / STEP_MM);
}

/**
 * The points of a tool whose outline can be edited: null for a taper with a ball and the cutter of
 * APT, which have arcs at odd places.
 */
export function pointsOf(tool: ToolInfo): ProfilePoint[] | null {
  const radius = (tool.diameter_mm ?? NEW_TOOL_MM.diameter) / 2;
  const length = tool.length_mm ?? NEW_TOOL_MM.length;
  const corner = tool.corner_radius_mm ?? 0;
  switch (tool.shape) {
    case 'ball':
      return [line(0, 0), arc(radius, radius, radius), line(radius, length)];
    case 'flat':
      return [line(0, 0), line(radius, 0), line(radius, length)];
    case 'bull_nose':
      return [
        line(0, 0),
        line(radius - corner, 0),
        arc(radius, corner, corner),
        line(radius, length),
      ];
    case 'cone_end': {
      const height = radius / Math.tan(((tool.tip_angle_deg ?? 90) * Math.PI) / 360);
      return [line(0, 0), line(radius, height), line(radius, length)];
    }
    case 'profile':
      return (tool.profile_mm ?? []).reduce<ProfilePoint[]>(
        (points, step) => [...points, pointOf(step, points.at(-1))],
        [],
      );
    default:
      return null;
  }
}

function pointOf(step: ProfileStep, before: ProfilePoint | undefined): ProfilePoint {
  if (!('to' in step)) return line(step[0], step[1]);
  const [r, z] = step.to;
  const { center, bulge = 'out' } = step;
  if (!center) return { r, z, edge: bulge, radius: step.radius ?? 0 };
  // A point of the arc's chord tells on which side of it the center lies.
  const from = before ?? line(0, 0);
  const cross = (r - from.r) * (center[1] - from.z) - (z - from.z) * (center[0] - from.r);
  const edge = cross >= 0 ? 'out' : 'in';
  return { r, z, edge, radius: Math.hypot(r - center[0], z - center[1]) };
}

/** The tool with another outline; shank and holder stay. */
export function withPoints(tool: ToolInfo, points: readonly ProfilePoint[]): ToolInfo {
  const { id, shank, holder } = tool;
  const profile_mm = points.map(({ r, z, edge, radius }): ProfileStep =>
    edge === 'line' ? [r, z] : { to: [r, z], radius, bulge: edge },
  );
  return {
    id,
    shape: 'profile',
    profile_mm,
    ...(shank ? { shank } : {}),
    ...(holder ? { holder } : {}),
  };
}

/** Half the distance from the point before: an arc's radius is not less. */
function leastRadius(points: readonly ProfilePoint[], n: number): number {
  const [to, from] = [points[n]!, points[n - 1] ?? line(0, 0)];
  return Math.ceil(Math.hypot(to.r - from.r, to.z - from.z) * 500) / 1000;
}

/** With a point changed; arcs at it get the radius that they need at least. */
export function withPoint(
  points: readonly ProfilePoint[],
  n: number,
  change: Partial<ProfilePoint>,
): ProfilePoint[] {
  const changed = points.map((point, at) => (at === n ? { ...point, ...change } : point));
  return changed.map((point, at) => {
    if (at !== n && at !== n + 1) return point;
    if (point.edge === 'line') return { ...point, radius: 0 };
    return { ...point, radius: Math.max(point.radius, leastRadius(changed, at)) };
  });
}

/** With a point in the middle of the line or arc to a point. */
export function withPointBefore(points: readonly ProfilePoint[], n: number): ProfilePoint[] {
  const [to, from] = [points[n]!, points[n - 1] ?? line(0, 0)];
  const middle = line(snapped((from.r + to.r) / 2), snapped((from.z + to.z) / 2));
  return [
    ...points.slice(0, n),
    middle,
    { ...to, edge: 'line', radius: 0 },
    ...points.slice(n + 1),
  ];
}

export function withoutPoint(points: readonly ProfilePoint[], n: number): ProfilePoint[] {
  return points
    .filter((_, at) => at !== n)
    .map((point, at) => (at === 0 ? { ...point, edge: 'line', radius: 0 } : point));
}

/** A ball end mill with an id that none of these has. */
export function newTool(tools: readonly ToolInfo[]): ToolInfo {
  const id = 1 + Math.max(0, ...tools.map((tool) => tool.id));
  return { id, shape: 'ball', diameter_mm: NEW_TOOL_MM.diameter, length_mm: NEW_TOOL_MM.length };
}
