// SPDX-License-Identifier: Apache-2.0
// What there is for those who have no file at hand: a program, which carves a flower of waves, and a
// block to carve by hand.

import type { ToolInfo } from '../wire/types';
import type { GivenFile } from './program_block';

const RADIUS_MM = 34;
const TURNS = 17;
const STEPS = 90; // of a turn
const PETALS = 7;

function point(turn: number): string {
  const angle = 2 * Math.PI * turn;
  const share = turn / TURNS;
  const radius = RADIUS_MM * share;
  const depth = 5.5 - 3.6 * share * share + 1.5 * share * Math.cos(PETALS * angle);
  const words = [radius * Math.cos(angle), radius * Math.sin(angle), -depth];
  return ['X', 'Y', 'Z'].map((axis, n) => axis + words[n]!.toFixed(3)).join(' ');
}

export function exampleProgram(): GivenFile {
  const lines = [
    '(Flower)',
    '(STOCK SIZE X80 Y80 Z12)',
    '(T1 D=8. - ball end mill)',
    'G21 G90 G17',
    'T1 M6',
    'S12000 M3',
    'G0 X0 Y0 Z5',
    `G1 ${point(0)} F600`,
  ];
  for (let step = 1; step <= TURNS * STEPS; step += 1) lines.push(`G1 ${point(step / STEPS)}`);
  lines.push('G0 Z5', 'M30', '');
  return { name: 'flower.ngc', bytes: new TextEncoder().encode(lines.join('\n')) };
}

const BLOCK = {
  name: 'Block',
  stock: { shape: 'box', min_mm: [-40, -40, -30], max_mm: [40, 40, 0] },
  accuracy: { pitch_mm: 0.25, tolerance_mm: 0.01 },
  tools: [
    { id: 1, shape: 'ball', diameter_mm: 8, length_mm: 35 },
    { id: 2, shape: 'ball', diameter_mm: 3, length_mm: 25 },
    { id: 3, shape: 'flat', diameter_mm: 6, length_mm: 30 },
    { id: 4, shape: 'bull_nose', diameter_mm: 12, corner_radius_mm: 3, length_mm: 35 },
  ],
};

export const EXAMPLE_TOOLS: readonly ToolInfo[] = BLOCK.tools;

export function exampleBlock(tools: readonly ToolInfo[]): GivenFile {
  const scene = JSON.stringify({ ...BLOCK, tools });
  return { name: 'block.json', bytes: new TextEncoder().encode(scene) };
}
