// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { SampleLog } from '../../src/carve/sample_log';
import type { Draft } from '../../src/carve/sample_log';
import { imagesOf } from '../../src/carve/mirror';
import { Sampler } from '../../src/carve/sampler';
import { angleBetween } from '../../src/carve/tool/vectors';
import { distance } from '../../src/model/vector';
import { BUTTON_CUTTING } from '../../src/wire/types';
import type { Vec3 } from '../../src/wire/types';

const GUEST = { speedMmPerS: 500, samplesPerS: 1250 };
const UP: Vec3 = [0, 0, 1];

function at(x: number, y = 0, z = 0): { tip: Vec3; axis: Vec3 } {
  return { tip: [x, y, z], axis: UP };
}

function cuts({ buttons }: Draft): boolean {
  return (buttons & BUTTON_CUTTING) !== 0;
}

/** Takes samples every 8 ms until none waits. */
function drain(sampler: Sampler, fromMs: number, mostMs = 5000): Draft[] {
  const samples: Draft[] = [];
  for (let ms = fromMs; ms < fromMs + mostMs; ms += 8) {
    samples.push(...sampler.take(ms * 1000));
    if (sampler.waiting === 0) break;
  }
  return samples;
}

function placed(limits = GUEST): Sampler {
  const sampler = new Sampler(7);
  sampler.limits = limits;
  sampler.push(at(0, 0, 5), false);
  expect(drain(sampler, 1000)).toMatchObject([
    { tip_mm: [0, 0, 5], buttons: 0, tool_id: 7, time_us: 1_000_000n },
  ]);
  return sampler;
}

function check(samples: readonly Draft[], speedMmPerS: number): void {
  for (let n = 1; n < samples.length; ++n) {
    const [a, b] = [samples[n - 1]!, samples[n]!];
    const seconds = Number(b.time_us - a.time_us) / 1e6;
    expect(seconds).toBeGreaterThan(0);
    if (cuts(b)) expect(distance(a.tip_mm, b.tip_mm) / seconds).toBeLessThanOrEqual(speedMmPerS);
  }
}

describe('sampler', () => {
  it('divides a long jump, so that no motion is faster than allowed', () => {
    const sampler = placed();
    sampler.push(at(0), true);
    sampler.push(at(90), true);
    const samples = drain(sampler, 1008);
    check([{ ...samples[0]!, time_us: 1_000_000n, tip_mm: [0, 0, 5] }, ...samples], 500);
    expect(samples.at(-1)!.tip_mm).toEqual([90, 0, 0]);
    expect(samples.every(cuts)).toBe(true);
    expect(samples.every(({ tip_mm: [x, y] }) => y === 0 && x >= 0 && x <= 90)).toBe(true);
    const seconds = Number(samples.at(-1)!.time_us) / 1e6 - 1;
    expect(seconds).toBeGreaterThan(95 / 500);
    expect(seconds).toBeLessThan(0.4);
  });

  it('keeps every corner of a path, in order', () => {
    const sampler = placed();
    const path = Array.from({ length: 20 }, (_, n) => at(n % 2, 0.1 * n));
    for (const pose of path) sampler.push(pose, true);
    const samples = drain(sampler, 1008);
    const tips = samples.map(({ tip_mm }) => tip_mm.join());
    let from = -1;
    for (const { tip } of path) {
      const found = tips.indexOf(
        tip.map((value) => Math.round(value * 1e6) / 1e6).join(),
        from + 1,
      );
      expect(found).toBeGreaterThan(from);
      from = found;
    }
  });

  it('sends no more samples than the server takes', () => {
    const sampler = placed({ speedMmPerS: 5000, samplesPerS: 1250 });
    const samples: Draft[] = [];
    for (let ms = 1008; ms < 2008; ms += 8) {
      for (let n = 0; n < 60; ++n) sampler.push(at((ms + n / 60) / 1000), true);
      samples.push(...sampler.take(ms * 1000));
    }
    expect(samples.length).toBeGreaterThan(900);
    expect(samples.length).toBeLessThan(1250);
    check(samples, 5000);
  });

  it('gives a turn of the axis its time, and divides it below the limit of the kernel', () => {
    const sampler = placed({ speedMmPerS: 5000, samplesPerS: 1250 });
    sampler.push(at(0), true);
    drain(sampler, 1008);
    sampler.push({ tip: [0, 0, 0], axis: [0, 0.01, -Math.sqrt(1 - 1e-4)] }, true);
    const samples = drain(sampler, 1108);
    let before = UP;
    for (const { axis } of samples) {
      expect(angleBetween(before, axis)).toBeLessThan((170 * Math.PI) / 180);
      before = axis;
    }
    expect(before[2]).toBeLessThan(-0.99);
    // 3.1 rad at 40 mm from the tip, with 1 m/s.
    expect(Number(samples.at(-1)!.time_us - samples[0]!.time_us)).toBeGreaterThan(20_000);
    expect(samples.length).toBeGreaterThan(2);
  });

  it('undoes and redoes a gesture of several strokes as a whole', () => {
    const sampler = placed();
    for (const x of [0, 10]) {
      sampler.push(at(x, 0, 5), false);
      sampler.push(at(x), true);
      sampler.push(at(x + 1), true);
    }
    sampler.push(at(11, 0, 5), false);
    sampler.endGesture();
    drain(sampler, 1008);
    expect(sampler.undo()).toBe(false);
    expect(sampler.takeRequests()).toMatchObject([{ type: 'change', undone: true, strokes: 2 }]);
    sampler.redo();
    expect(sampler.takeRequests()).toMatchObject([{ type: 'change', undone: false, strokes: 2 }]);
    sampler.undo();
    sampler.undo(); // an earlier one, of which the page knows nothing
    expect(sampler.takeRequests()).toMatchObject([
      { type: 'change', undone: true, strokes: 2 },
      { type: 'change', undone: true, strokes: 1 },
    ]);
  });

  it('takes a gesture back that only waits, without the server', () => {
    const sampler = placed();
    sampler.push(at(0), true);
    sampler.push(at(0, 0, 5), false);
    sampler.push(at(9, 0, 5), false);
    sampler.push(at(9), true);
    sampler.push(at(9, 0, 5), false);
    sampler.endGesture();
    expect(sampler.undo()).toBe(true);
    expect(drain(sampler, 1008).filter(cuts)).toEqual([]);
    expect(sampler.redo()).toBe(true);
    expect(drain(sampler, 2008).filter(cuts).length).toBeGreaterThan(0);
  });

  it('repeats a gesture in the mirror, sample by sample as it was sent', () => {
    for (const mirror of ['x', 'y', 'z', 3] as const) {
      const sampler = placed({ speedMmPerS: 400, samplesPerS: 1250 });
      const images = imagesOf(mirror, [5, -3.25, 2]);
      sampler.images = images;
      sampler.push(at(1, 0, 5), false);
      for (const x of [1, 1.5, 60, 61]) sampler.push(at(x, x / 3, -1), true);
      sampler.push(at(61, 0, 5), false);
      sampler.endGesture();
      sampler.push(at(70, 0, 5), false);
      const samples: Draft[] = [];
      for (let ms = 1008; ms < 4000; ms += 8) {
        samples.push(...sampler.take(ms * 1000));
        expect(sampler.takeRequests()).toEqual([]);
      }
      check(samples, 400);
      const strokes: Draft[][] = [];
      samples.forEach((sample, n) => {
        if (!cuts(sample)) return;
        const before = samples[n - 1]!;
        if (!cuts(before)) strokes.push([before]);
        const isRest = distance(before.tip_mm, sample.tip_mm) === 0;
        if (!isRest) strokes.at(-1)!.push(sample);
      });
      expect(strokes).toHaveLength(1 + images.length);
      const [drawn, ...others] = strokes as [Draft[], ...Draft[][]];
      expect(drawn.length).toBeGreaterThan(10); // the jump was divided
      others.forEach((stroke, n) => {
        expect(stroke).toHaveLength(drawn.length);
        stroke.forEach(({ tip_mm, axis }, m) => {
          const { tip_mm: tip, axis: from } = drawn[m]!;
          const expected = images[n]!({ tip, axis: from });
          for (let i = 0; i < 3; i += 1) expect(tip_mm[i]).toBeCloseTo(expected.tip[i]!, 6);
          expect(axis).toEqual(expected.axis);
        });
      });
      sampler.undo();
      expect(sampler.takeRequests()).toMatchObject([
        { type: 'change', undone: true, strokes: 1 + images.length },
      ]);
    }
  });

  it('sends a tool that rests in the cut, and none that rests in the air', () => {
    const sampler = placed();
    sampler.push(at(0), true);
    drain(sampler, 1008);
    for (let ms = 1100; ms < 1200; ms += 8) {
      expect(sampler.take(ms * 1000)).toMatchObject([{ tip_mm: [0, 0, 0], buttons: 3 }]);
    }
    sampler.push(at(0, 0, 5), false);
    expect(sampler.take(1_208_000)).toMatchObject([{ tip_mm: [0, 0, 5], buttons: 0 }]);
    expect(sampler.take(1_300_000)).toEqual([]);
  });

  it('does not stretch the first motion over the pause before it', () => {
    const sampler = placed();
    sampler.push(at(0, 0, 1), false);
    sampler.push(at(0, 0, 0), true);
    const [lifted, first] = sampler.take(9_000_000);
    expect(lifted).toMatchObject({ buttons: 0 });
    expect(Number(first!.time_us - lifted!.time_us)).toBeLessThanOrEqual(100_000);
  });

  it('sends only the newest of the places through the air', () => {
    const sampler = placed();
    for (let x = 0; x < 10; ++x) sampler.push(at(x, 0, 5), false);
    expect(sampler.waiting).toBe(1);
    expect(sampler.take(1_008_000)).toMatchObject([{ tip_mm: [9, 0, 5] }]);
  });

  it('rounds tips to the grid of poses', () => {
    const sampler = placed();
    sampler.push(at(1 / 3), false);
    expect(sampler.take(1_008_000)[0]!.tip_mm[0]).toBeCloseTo(0.333333, 9);
  });

  it('sends waiting poses with the tool that drew them, and begins without a motion with another', () => {
    const sampler = placed();
    sampler.push(at(0), true);
    sampler.push(at(90), true);
    sampler.push(at(90, 0, 5), false);
    sampler.tool = 7;
    sampler.tool = 8;
    sampler.push(at(40, 0, 5), false);
    sampler.push(at(40), true);
    const samples = drain(sampler, 1008);
    const drawn = samples.filter(cuts);
    expect(drawn.filter(({ tool_id }) => tool_id === 7).at(-1)!.tip_mm).toEqual([90, 0, 0]);
    expect(drawn.at(-1)).toMatchObject({ tool_id: 8, tip_mm: [40, 0, 0] });
    const [first] = samples.filter(({ tool_id }) => tool_id === 8);
    expect(first).toMatchObject({ buttons: 0, tip_mm: [40, 0, 5] });
  });
});

describe('sample log', () => {
  const draft = (): Draft => ({
    time_us: 1n,
    tip_mm: [0, 0, 0],
    axis: UP,
    tool_id: 1,
    buttons: 0,
    felt_share: 0,
  });
  const numbers = (samples: { agent_sequence: bigint }[]) =>
    samples.map(({ agent_sequence }) => Number(agent_sequence));

  it('numbers samples from 1, over all connections', () => {
    const log = new SampleLog();
    expect(numbers(log.add([draft(), draft()]))).toEqual([1, 2]);
    log.toResend(2n);
    expect(numbers(log.add([draft()]))).toEqual([3]);
  });

  it('sends again from the newest sample that the server has', () => {
    const log = new SampleLog();
    log.add(Array.from({ length: 9 }, draft));
    log.durable(4n);
    expect(numbers(log.toResend(6n))).toEqual([6, 7, 8, 9]);
    // A server that was restarted may have less than was answered, but never less than is durable.
    expect(numbers(log.toResend(0n))).toEqual([4, 5, 6, 7, 8, 9]);
  });

  it('counts unanswered samples', () => {
    const log = new SampleLog();
    log.add(Array.from({ length: 5 }, draft));
    log.answered(3n);
    log.answered(2n);
    expect(log.unanswered).toBe(2);
  });

  it('does not keep samples without limit', () => {
    const log = new SampleLog();
    log.add(Array.from({ length: 20_000 }, draft));
    const kept = log.toResend(0n);
    expect(kept.length).toBe(16_384);
    expect(kept.at(-1)!.agent_sequence).toBe(20_000n);
  });
});
