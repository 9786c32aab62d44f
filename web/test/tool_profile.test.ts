// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { toolName, toolProfile } from '../src/model/tool_profile';
import type { ProfileStep } from '../src/wire/types';

describe('tool profile', () => {
  const base = { id: 1, diameter_mm: 10, length_mm: 60 };
  const lollipop: ProfileStep[] = [[0, 0], { to: [3, 9], center: [0, 5] }, [3, 30]];
  const cornerRounder: ProfileStep[] = [
    [4, 0],
    [4, 2],
    { to: [8, 6], radius: 4, bulge: 'in' },
    [8, 20],
  ];

  it.each([
    { ...base, shape: 'ball' },
    { ...base, shape: 'flat' },
    { ...base, shape: 'cone_end', tip_angle_deg: 90 },
    { ...base, shape: 'taper', half_angle_deg: 5 },
    { ...base, shape: 'taper', half_angle_deg: 5, tip: 'ball' as const },
    { ...base, shape: 'bull_nose', corner_radius_mm: 2 },
    { ...base, shape: 'unknown' },
    {
      id: 1,
      shape: 'apt',
      d_mm: 10,
      r_mm: 1,
      e_mm: 4,
      f_mm: 1,
      alpha_deg: 0,
      beta_deg: 0,
      h_mm: 50,
    },
    {
      id: 1,
      shape: 'apt',
      d_mm: 16,
      r_mm: 60,
      e_mm: -52,
      f_mm: 20,
      alpha_deg: 0,
      beta_deg: 0,
      h_mm: 35,
    },
    {
      id: 1,
      shape: 'apt',
      d_mm: 10,
      r_mm: 0,
      e_mm: 5,
      f_mm: 5,
      alpha_deg: 45,
      beta_deg: 0,
      h_mm: 30,
    },
    { id: 1, shape: 'profile', profile_mm: lollipop },
    { id: 1, shape: 'profile', profile_mm: cornerRounder },
  ])('of $shape runs from the tip to the top without a gap', (tool) => {
    const { pieces, lengthMm } = toolProfile(tool);
    expect(pieces[0]?.[0]).toEqual([expect.closeTo(0, 9), expect.closeTo(0, 9)]);
    for (let i = 1; i < pieces.length; ++i) {
      const [r0, z0] = pieces[i - 1]?.at(-1) as [number, number];
      const [r1, z1] = pieces[i]?.[0] as [number, number];
      expect(Math.hypot(r1 - r0, z1 - z0)).toBeLessThan(1e-9);
    }
    const heights = pieces.flat().map(([, z]) => z);
    expect(Math.min(...heights)).toBeCloseTo(0, 9);
    expect(Math.max(...heights)).toBeCloseTo(lengthMm, 9);
  });

  it('has the radius and height of its shape', () => {
    expect(toolProfile({ ...base, shape: 'ball' }).radiusMm).toBe(5);
    const taper = toolProfile({ ...base, shape: 'taper', half_angle_deg: 45 });
    expect(taper.radiusMm).toBeCloseTo(65, 9);
    const cone = toolProfile({ ...base, shape: 'cone_end', tip_angle_deg: 90 });
    expect(cone.pieces[0]?.[1]).toEqual([5, expect.closeTo(5, 9)]);
  });

  it('has a tangent ball at a tapered tip', () => {
    const { pieces } = toolProfile({ ...base, shape: 'taper', half_angle_deg: 20, tip: 'ball' });
    const [r, z] = pieces[1]?.[0] as [number, number];
    expect(Math.hypot(r, z - 5)).toBeCloseTo(5, 9);
    const [r2, z2] = pieces[1]?.[1] as [number, number];
    // Tangent: the side is perpendicular to the ball's radius.
    expect((r2 - r) * r + (z2 - z) * (z - 5)).toBeCloseTo(0, 9);
  });

  it('draws arcs of a profile on the side to which they bulge', () => {
    const [ball] = toolProfile({ id: 1, shape: 'profile', profile_mm: lollipop }).pieces as [
      [number, number][],
    ];
    for (const [r, z] of ball) expect(Math.hypot(r, z - 5)).toBeCloseTo(5, 9);
    expect(toolProfile({ id: 1, shape: 'profile', profile_mm: lollipop }).radiusMm).toBeCloseTo(
      5,
      1,
    );
    const fillet = toolProfile({ id: 1, shape: 'profile', profile_mm: cornerRounder })
      .pieces[2] as [number, number][];
    for (const [r, z] of fillet) expect(Math.hypot(r - 8, z - 2)).toBeCloseTo(4, 9);
    const byRadius = toolProfile({
      id: 1,
      shape: 'profile',
      profile_mm: [[3, 0], { to: [5, 2], radius: 2 }, [5, 9]],
    });
    for (const [r, z] of byRadius.pieces[1] as [number, number][])
      expect(Math.hypot(r - 3, z - 2)).toBeCloseTo(2, 9);
  });

  it('of an APT cutter without angles equals a bull nose', () => {
    const apt = toolProfile({
      id: 1,
      shape: 'apt',
      d_mm: 10,
      r_mm: 1,
      e_mm: 4,
      f_mm: 1,
      alpha_deg: 0,
      beta_deg: 0,
      h_mm: 50,
    });
    const same = toolProfile({
      id: 1,
      shape: 'bull_nose',
      diameter_mm: 10,
      corner_radius_mm: 1,
      length_mm: 50,
    });
    const rounded = (pieces: [number, number][][]): number[][][] =>
      pieces.map((p) =>
        p.map(([r, z]) => [Math.round(r * 1e9) / 1e9 + 0, Math.round(z * 1e9) / 1e9 + 0]),
      );
    expect(rounded(apt.pieces)).toEqual(rounded(same.pieces));
  });

  it('stacks shank and holder on the cutting length', () => {
    const shank = { diameter_mm: 6, length_mm: 20 };
    const { body } = toolProfile({
      ...base,
      shape: 'flat',
      shank,
      holder: [
        { diameter_mm: 20, length_mm: 8 },
        { diameter_mm: 30, top_diameter_mm: 40, length_mm: 9 },
      ],
    });
    expect(body.topMm).toBe(97);
    expect(body.pieces.at(-2)).toEqual([
      [15, 88],
      [20, 97],
    ]);
    expect(
      toolProfile({
        ...base,
        shape: 'flat',
        shank,
        holder: {
          profile_mm: [
            [9, 0],
            [12, 25],
          ],
        },
      }).body.topMm,
    ).toBe(105);
    expect(toolProfile({ ...base, shape: 'flat' }).body.pieces).toEqual([]);
  });

  it('has a readable name', () => {
    expect(toolName({ id: 1, shape: 'apt', d_mm: 10 })).toBe('apt 10 mm');
    expect(
      toolName({
        id: 1,
        shape: 'profile',
        profile_mm: [
          [4, 0],
          [4, 9],
        ],
      }),
    ).toBe('profile 8 mm');
    expect(toolName({ ...base, shape: 'cone_end' })).toBe('cone end 10 mm');
    expect(toolName(undefined)).toBe('no tool');
  });
});
