// SPDX-License-Identifier: Apache-2.0
// The outline of a tool: smooth pieces of its meridian as points (r, z), with the tip at the origin
// and z up the axis. Pieces meet in sharp edges, so each is lathed separately and keeps its own
// normals. Lengths in mm.

import { t } from '../strings';
import { shapeName } from '../strings/names';
import type { ToolInfo } from '../wire/types';
import { aptOutline, arc, bodyOutline, profileOutline } from './tool_outline';
import type { BodyOutline, OutlinePoint } from './tool_outline';

export type { OutlinePoint };

export interface ToolProfile {
  pieces: OutlinePoint[][];
  lengthMm: number;
  /** Largest radius. */
  radiusMm: number;
  /** Radius at the upper end of the cutting part. */
  topRadiusMm: number;
  /** Shank and holder, if the scene defines them; they end at `body.topMm`. */
  body: BodyOutline;
}

type Cutter = Omit<ToolProfile, 'body'>;

function finish(pieces: OutlinePoint[][], lengthMm: number): Cutter {
  const last = pieces.at(-1)!.at(-1)!;
  const radiusMm = Math.max(...pieces.flat().map(([r]) => r));
  return {
    pieces: [...pieces, [last, [0, last[1]]]],
    lengthMm,
    radiusMm,
    topRadiusMm: last[0],
  };
}

function taper(radius: number, halfAngle: number, length: number, ballTip: boolean): Cutter {
  const slope = Math.tan(halfAngle);
  if (!ballTip) {
    return finish(
      [
        [
          [0, 0],
          [radius, 0],
        ],
        [
          [radius, 0],
          [radius + slope * length, length],
        ],
      ],
      length,
    );
  }
  // The ball ends where it is tangent to the side, so that the outline has no edge there.
  const tipArc = arc(0, radius, radius, -Math.PI / 2, -halfAngle);
  const [r, z] = tipArc.at(-1)!;
  return finish(
    [
      tipArc,
      [
        [r, z],
        [r + slope * Math.max(0, length - z), Math.max(z, length)],
      ],
    ],
    length,
  );
}

function drawn(pieces: OutlinePoint[][]): Cutter {
  return finish(pieces, pieces.at(-1)!.at(-1)![1]);
}

/**
 * Returns the outline of a tool as the scene defines it. Unknown shapes become a cylinder of the
 * tool's diameter and length.
 */
export function toolProfile(tool: ToolInfo): ToolProfile {
  const cutter = cutterProfile(tool);
  return { ...cutter, body: bodyOutline(tool, cutter.lengthMm) };
}

function cutterProfile(tool: ToolInfo): Cutter {
  const radius = Math.max(0.05, (tool.diameter_mm ?? 6) / 2);
  const length = Math.max(radius, tool.length_mm ?? 40);
  const side = (z: number): OutlinePoint[] => [
    [radius, z],
    [radius, Math.max(z, length)],
  ];
  switch (tool.shape) {
    case 'ball':
      return finish([arc(0, radius, radius, -Math.PI / 2, 0), side(radius)], length);
    case 'taper': {
      const halfAngle = ((tool.half_angle_deg ?? 10) * Math.PI) / 180;
      return taper(radius, halfAngle, length, tool.tip === 'ball');
    }
    case 'cone_end': {
      const height = radius / Math.tan(((tool.tip_angle_deg ?? 90) * Math.PI) / 360);
      return finish(
        [
          [
            [0, 0],
            [radius, height],
          ],
          side(height),
        ],
        length,
      );
    }
    case 'bull_nose': {
      const corner = Math.min(radius, Math.max(0, tool.corner_radius_mm ?? 0));
      const flat: OutlinePoint[] = [
        [0, 0],
        [radius - corner, 0],
      ];
      return finish(
        [flat, arc(radius - corner, corner, corner, -Math.PI / 2, 0), side(corner)],
        length,
      );
    }
    case 'apt':
      return drawn(aptOutline(tool));
    case 'profile':
      if (tool.profile_mm && tool.profile_mm.length > 1)
        return drawn(profileOutline(tool.profile_mm));
      return finish(
        [
          [
            [0, 0],
            [radius, 0],
          ],
          side(0),
        ],
        length,
      );
    default: // flat, and unknown shapes
      return finish(
        [
          [
            [0, 0],
            [radius, 0],
          ],
          side(0),
        ],
        length,
      );
  }
}

/** Returns the tool's name in the list of participants: shape and diameter. */
export function toolName(tool: ToolInfo | undefined): string {
  if (!tool) return t('no tool');
  const wide = tool.diameter_mm ?? tool.d_mm ?? (tool.profile_mm && 2 * toolProfile(tool).radiusMm);
  const diameter = wide === undefined ? '' : ` ${Number(wide.toFixed(2))} mm`;
  return shapeName(tool.shape) + diameter;
}
