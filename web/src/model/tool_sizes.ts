// SPDX-License-Identifier: Apache-2.0
// The tools that are made while one carves: a shape of the palette with a diameter.

import type { ToolInfo } from '../wire/types';

export type NewTool = Omit<ToolInfo, 'id'>;

/** Of tools that are made, mm. */
export const DIAMETER_MM = { least: 0.5, most: 40 };
export const PALETTE = ['ball', 'flat', 'bull_nose', 'cone_end'] as const;
export type PaletteShape = (typeof PALETTE)[number];

const STEP_FACTOR = 1.15;
const CORNER_SHARE = 0.2; // of the diameter
const TIP_ANGLE_DEG = 60;
const LENGTH_DIAMETERS = 1.5; // at least
const FIRST_LENGTH_MM = 30;
/** Steps of neat diameters, up to a diameter, mm. */
const NEAT: readonly (readonly [upTo: number, step: number])[] = [
  [2, 0.1],
  [10, 0.5],
  [20, 1],
  [Infinity, 2],
];

function rounded(mm: number): number {
  return Number(mm.toFixed(3));
}

/** A diameter in the range, to 0.01 mm. */
export function clampedMm(mm: number): number {
  return Number(Math.min(DIAMETER_MM.most, Math.max(DIAMETER_MM.least, mm)).toFixed(2));
}

/** The next neat diameter, about 15 % larger or smaller. */
export function nextDiameter(mm: number, direction: 1 | -1): number {
  const wish = mm * STEP_FACTOR ** direction;
  const [, step] = NEAT.find(([upTo]) => wish <= upTo)!;
  return clampedMm(Math.round(wish / step) * step);
}

/** Of a tool that a diameter describes; null of others. */
export function diameterOf({ shape, diameter_mm }: ToolInfo): number | null {
  return shape !== 'apt' && shape !== 'profile' && diameter_mm !== undefined ? diameter_mm : null;
}

function longEnough(lengthMm: number | undefined, diameterMm: number): number {
  return Math.max(lengthMm ?? FIRST_LENGTH_MM, rounded(LENGTH_DIAMETERS * diameterMm));
}

/** The tool with another diameter; null if it has none. Shank and holder stay. */
export function withDiameter(tool: ToolInfo, mm: number): NewTool | null {
  const before = diameterOf(tool);
  if (before === null) return null;
  const { id: _, ...rest } = tool;
  const corner = tool.corner_radius_mm;
  return {
    ...rest,
    diameter_mm: mm,
    length_mm: longEnough(tool.length_mm, mm),
    ...(corner === undefined ? {} : { corner_radius_mm: rounded((corner * mm) / before) }),
  };
}

/** A tool of the palette as long as another one, with its shank and holder. */
export function withShape(tool: ToolInfo, shape: PaletteShape, mm: number): NewTool {
  const { shank, holder } = tool;
  const lengthMm = longEnough(tool.length_mm, mm);
  return {
    shape,
    diameter_mm: mm,
    length_mm: lengthMm,
    ...(shape === 'bull_nose' ? { corner_radius_mm: rounded(CORNER_SHARE * mm) } : {}),
    ...(shape === 'cone_end' ? { tip_angle_deg: TIP_ANGLE_DEG } : {}),
    ...(shank ? { shank } : {}),
    ...(holder ? { holder } : {}),
  };
}

/** The tool of a list that is the same as a new one, if there is one: no other need be made. */
export function sameTool(tools: readonly ToolInfo[], made: NewTool): ToolInfo | undefined {
  const names = new Set<string>(Object.keys(made));
  return tools.find((tool) => {
    const fields = Object.keys(tool).filter((name) => name !== 'id');
    return (
      fields.length === names.size &&
      fields.every(
        (name) =>
          JSON.stringify(tool[name as keyof ToolInfo]) ===
          JSON.stringify(made[name as keyof NewTool]),
      )
    );
  });
}
