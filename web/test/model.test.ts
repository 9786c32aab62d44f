// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Backoff } from '../src/link/backoff';
import { RateMeter, ServerClock } from '../src/model/clock';
import { boxCenter, fitDistance } from '../src/model/fit';
import { Quality } from '../src/model/quality';
import { stockBounds } from '../src/model/session';
import { toolName, toolProfile } from '../src/model/tool_profile';
import { figure, sentence, volume } from '../src/ui/format';
import type { ProfileStep } from '../src/wire/types';

describe('server clock', () => {
  it('maps server times to local ones by the fastest frames, whatever the offset', () => {
    const clock = new ServerClock();
    const offsetMs = 123456;
    for (let i = 0; i < 50; ++i) clock.arrived(1000 + i * 20 + (i % 5), BigInt(Math.round((1000 + i * 20 - offsetMs + 1e6) * 1000)));
    const serverUs = BigInt(Math.round((2000 - offsetMs + 1e6) * 1000));
    expect(clock.toLocalMs(serverUs)).toBeCloseTo(2000, 6);
  });

  it('tells the age of a frame apart from the clock offset by ping pairs', () => {
    const clock = new ServerClock();
    expect(clock.ageMs(0, 0n)).toBeNaN();
    clock.pong(1000, 1040, 5_020_000n); // server is 4000 ms ahead, 20 ms each way
    expect(clock.rttMs).toBeCloseTo(40, 9);
    expect(clock.ageMs(1100, 5_070_000n)).toBeCloseTo(30, 6);
  });

  it('prefers the fastest ping pair', () => {
    const clock = new ServerClock();
    clock.pong(0, 10, 1_000_005_000n);
    clock.pong(100, 900, 1_000_100_100n); // a lopsided slow pair must not spoil the offset
    expect(clock.ageMs(1000, 1_000_900_000n)).toBeCloseTo(100, 3);
  });

  it('counts events of the last second', () => {
    const meter = new RateMeter();
    for (let t = 0; t < 5000; t += 50) meter.tick(t);
    expect(meter.perSecond(4950)).toBe(20);
    expect(meter.perSecond(9000)).toBe(0);
  });
});

describe('quality', () => {
  it('steps down on slow frames, and up again only after many quick ones', () => {
    const quality = new Quality(2);
    expect(quality.movingRatio).toBe(2);
    for (let i = 0; i < 6; ++i) quality.frame(60);
    const lowered = quality.movingRatio;
    expect(lowered).toBeLessThan(2);
    for (let i = 0; i < 20; ++i) quality.frame(8);
    expect(quality.movingRatio).toBe(lowered);
    for (let i = 0; i < 100; ++i) quality.frame(8);
    expect(quality.movingRatio).toBe(2);
    expect(quality.stillRatio).toBe(2);
  });

  it('has a floor, and does not take a sleeping tab for a slow device', () => {
    const quality = new Quality(1);
    for (let i = 0; i < 50; ++i) quality.frame(5000);
    expect(quality.movingRatio).toBe(1);
    for (let i = 0; i < 1000; ++i) quality.frame(60);
    expect(quality.movingRatio).toBeGreaterThan(0.2);
  });
});

describe('quality on a hopeless device', () => {
  it('leaves room between frames until the picture stands still', () => {
    const quality = new Quality(1, true);
    expect(quality.pauseMs).toBe(0);
    for (let i = 0; i < 60; ++i) quality.frame(200);
    expect(quality.pauseMs).toBeGreaterThan(50);
    quality.rested();
    expect(quality.pauseMs).toBe(0);
  });
});

describe('backoff', () => {
  it('doubles up to a limit and begins anew after a success', () => {
    const backoff = new Backoff(250, 8000, () => 1);
    expect([1, 2, 3, 4, 5, 6, 7].map(() => backoff.next())).toEqual([250, 500, 1000, 2000, 4000, 8000, 8000]);
    backoff.reset();
    expect(backoff.next()).toBe(250);
  });
});

describe('tool profile', () => {
  const base = { id: 1, diameter_mm: 10, length_mm: 60 };
  const lollipop: ProfileStep[] = [[0, 0], { to: [3, 9], center: [0, 5] }, [3, 30]];
  const cornerRounder: ProfileStep[] = [[4, 0], [4, 2], { to: [8, 6], radius: 4, bulge: 'in' }, [8, 20]];

  it.each([
    { ...base, shape: 'ball' }, { ...base, shape: 'flat' }, { ...base, shape: 'cone_end', tip_angle_deg: 90 },
    { ...base, shape: 'taper', half_angle_deg: 5 }, { ...base, shape: 'taper', half_angle_deg: 5, tip: 'ball' as const },
    { ...base, shape: 'bull_nose', corner_radius_mm: 2 }, { ...base, shape: 'of the future' },
    { id: 1, shape: 'apt', d_mm: 10, r_mm: 1, e_mm: 4, f_mm: 1, alpha_deg: 0, beta_deg: 0, h_mm: 50 },
    { id: 1, shape: 'apt', d_mm: 16, r_mm: 60, e_mm: -52, f_mm: 20, alpha_deg: 0, beta_deg: 0, h_mm: 35 },
    { id: 1, shape: 'apt', d_mm: 10, r_mm: 0, e_mm: 5, f_mm: 5, alpha_deg: 45, beta_deg: 0, h_mm: 30 },
    { id: 1, shape: 'profile', profile_mm: lollipop }, { id: 1, shape: 'profile', profile_mm: cornerRounder },
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

  it('gives each shape its measures', () => {
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
    expect((r2 - r) * r + (z2 - z) * (z - 5)).toBeCloseTo(0, 9); // the side is perpendicular to the ball's radius
  });

  it('draws the arcs of a profile on the side to which they bulge', () => {
    const [ball] = toolProfile({ id: 1, shape: 'profile', profile_mm: lollipop }).pieces as [[number, number][]];
    for (const [r, z] of ball) expect(Math.hypot(r, z - 5)).toBeCloseTo(5, 9);
    expect(toolProfile({ id: 1, shape: 'profile', profile_mm: lollipop }).radiusMm).toBeCloseTo(5, 1);
    const fillet = toolProfile({ id: 1, shape: 'profile', profile_mm: cornerRounder }).pieces[2] as [number, number][];
    for (const [r, z] of fillet) expect(Math.hypot(r - 8, z - 2)).toBeCloseTo(4, 9);
    const byRadius = toolProfile({ id: 1, shape: 'profile', profile_mm: [[3, 0], { to: [5, 2], radius: 2 }, [5, 9]] });
    for (const [r, z] of byRadius.pieces[1] as [number, number][]) expect(Math.hypot(r - 3, z - 2)).toBeCloseTo(2, 9);
  });

  it('makes an APT cutter without angles a bull nose', () => {
    const apt = toolProfile({ id: 1, shape: 'apt', d_mm: 10, r_mm: 1, e_mm: 4, f_mm: 1, alpha_deg: 0, beta_deg: 0, h_mm: 50 });
    const same = toolProfile({ id: 1, shape: 'bull_nose', diameter_mm: 10, corner_radius_mm: 1, length_mm: 50 });
    const rounded = (pieces: [number, number][][]): number[][][] => pieces.map((p) => p.map(([r, z]) => [
      Math.round(r * 1e9) / 1e9 + 0, Math.round(z * 1e9) / 1e9 + 0]));
    expect(rounded(apt.pieces)).toEqual(rounded(same.pieces));
  });

  it('stacks shank and holder on the cutting length', () => {
    const shank = { diameter_mm: 6, length_mm: 20 };
    const { body } = toolProfile({ ...base, shape: 'flat', shank, holder: [
      { diameter_mm: 20, length_mm: 8 }, { diameter_mm: 30, top_diameter_mm: 40, length_mm: 9 }] });
    expect(body.topMm).toBe(97);
    expect(body.pieces.at(-2)).toEqual([[15, 88], [20, 97]]);
    expect(toolProfile({ ...base, shape: 'flat', shank, holder: { profile_mm: [[9, 0], [12, 25]] } }).body.topMm).toBe(105);
    expect(toolProfile({ ...base, shape: 'flat' }).body.pieces).toEqual([]);
  });

  it('has a name for people', () => {
    expect(toolName({ id: 1, shape: 'apt', d_mm: 10 })).toBe('apt 10 mm');
    expect(toolName({ id: 1, shape: 'profile', profile_mm: [[4, 0], [4, 9]] })).toBe('profile 8 mm');
    expect(toolName({ ...base, shape: 'cone_end' })).toBe('cone end 10 mm');
    expect(toolName(undefined)).toBe('no tool');
  });
});

describe('fit', () => {
  const cube = { min: [-1, -1, -1] as [number, number, number], max: [1, 1, 1] as [number, number, number] };

  it('puts the near face of a cube just inside the picture', () => {
    expect(fitDistance(cube, [0, -1, 0], 0.5, 0.5)).toBeCloseTo(1 + 1 / 0.5, 9);
  });

  it('goes by the narrower side of the picture', () => {
    expect(fitDistance(cube, [0, -1, 0], 0.25, 0.5)).toBeCloseTo(1 + 1 / 0.25, 9);
    expect(fitDistance(cube, [0, -1, 0], 0.5, 0.25)).toBeCloseTo(1 + 1 / 0.25, 9);
  });

  it('sees every corner of a lopsided box from anywhere', () => {
    const box = { min: [5, -40, 2] as [number, number, number], max: [90, 11, 9] as [number, number, number] };
    for (let i = 0; i < 200; ++i) {
      const [a, b] = [i * 0.7, Math.sin(i * 1.3) * 1.5];
      const to = [Math.cos(a) * Math.cos(b), Math.sin(a) * Math.cos(b), Math.sin(b)] as const;
      const distance = fitDistance(box, to, 0.4, 0.3);
      const camera = boxCenter(box).map((c, k) => c + distance * (to[k] as number));
      for (const corner of [box.min, box.max, [5, 11, 2], [90, -40, 9], [5, -40, 9], [90, 11, 2], [5, 11, 9], [90, -40, 2]]) {
        const arm = corner.map((c, k) => c - (camera[k] as number));
        const depth = -(arm[0]! * to[0] + arm[1]! * to[1] + arm[2]! * to[2]);
        const sideways = (arm[0]! * -Math.sin(a) + arm[1]! * Math.cos(a));
        expect(depth).toBeGreaterThan(0);
        expect(Math.abs(sideways) / depth).toBeLessThan(0.4 + 1e-9);
      }
    }
  });
});

describe('figures', () => {
  it('are short and keep three digits', () => {
    expect([0, 0.01234, 1.2345, 12.345, 123.45, 123456].map(figure)).toEqual(['0', '0.0123', '1.23', '12.3', '123', '123,456']);
    expect(volume(999)).toEqual(['999', 'mm³']);
    expect(volume(49666)).toEqual(['49.7', 'cm³']);
  });

  it('and reasons read well', () => {
    expect(sentence('no hello within 5 s')).toBe('No hello within 5 s.');
    expect(sentence('All is well.')).toBe('All is well.');
  });

  it('bound a cylinder', () => {
    expect(stockBounds({ shape: 'cylinder', center_mm: [1, 2], radius_mm: 3, min_z_mm: -4, max_z_mm: 5 }))
      .toEqual({ min: [-2, -1, -4], max: [4, 5, 5] });
  });
});
