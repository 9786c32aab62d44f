// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import {
  DIAMETER_MM,
  nextDiameter,
  sameTool,
  withDiameter,
  withShape,
} from '../src/model/tool_sizes';

describe('tool sizes', () => {
  it('go from the least to the greatest diameter in neat steps, and back', () => {
    const up: number[] = [DIAMETER_MM.least];
    while (up.at(-1)! < DIAMETER_MM.most) up.push(nextDiameter(up.at(-1)!, 1));
    expect(up).toEqual([...new Set(up)]);
    expect(up.slice(0, 6)).toEqual([0.5, 0.6, 0.7, 0.8, 0.9, 1]);
    expect(up).toContain(6);
    expect(up.every((mm) => Number(mm.toFixed(1)) === mm)).toBe(true);
    expect(up.length).toBeLessThan(45);
    let mm: number = DIAMETER_MM.most;
    for (let n = 0; n < 100; ++n) {
      const next = nextDiameter(mm, -1);
      expect(next <= mm).toBe(true);
      mm = next;
    }
    expect(mm).toBe(DIAMETER_MM.least);
    expect(nextDiameter(DIAMETER_MM.most, 1)).toBe(DIAMETER_MM.most);
  });

  it('leave the shape, with a corner in proportion and a length that is enough', () => {
    const tool = {
      id: 4,
      shape: 'bull_nose',
      diameter_mm: 10,
      corner_radius_mm: 2,
      length_mm: 20,
      shank: { diameter_mm: 8, length_mm: 30 },
    };
    expect(withDiameter(tool, 20)).toEqual({
      shape: 'bull_nose',
      diameter_mm: 20,
      corner_radius_mm: 4,
      length_mm: 30,
      shank: { diameter_mm: 8, length_mm: 30 },
    });
    expect(withDiameter({ id: 1, shape: 'profile', profile_mm: [] }, 3)).toBeNull();
    expect(withShape(tool, 'cone_end', 3)).toEqual({
      shape: 'cone_end',
      diameter_mm: 3,
      tip_angle_deg: 60,
      length_mm: 20,
      shank: { diameter_mm: 8, length_mm: 30 },
    });
  });

  it('know the tool that is there, whatever its number', () => {
    const ball = { shape: 'ball', diameter_mm: 6, length_mm: 30 };
    const tools = [
      { id: 1, ...ball, length_mm: 31 },
      { id: 2, ...ball, shank: { diameter_mm: 6, length_mm: 9 } },
      { id: 3, ...ball },
    ];
    expect(sameTool(tools, ball)?.id).toBe(3);
    expect(sameTool(tools.slice(0, 2), ball)).toBeUndefined();
  });
});
