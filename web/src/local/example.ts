// SPDX-License-Identifier: Apache-2.0
// A program for those who have none at hand: a flower of waves.

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
