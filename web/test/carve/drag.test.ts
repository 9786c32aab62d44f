// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from 'vitest';
import { Drag } from '../../src/carve/drag';
import type { DragStep, DragStrength } from '../../src/carve/drag';

const TICK_MS = 8;
const PX_PER_MM = 10;

function step(px: number): DragStep {
  return {
    place: { x: px, y: 0, pressure: null, tilt: null },
    pose: { tip: [px / PX_PER_MM, 0, -1], axis: [0, 0, 1] },
  };
}

describe('drag by the cutting force', () => {
  let drag: Drag;
  let nowMs: number;
  let pointerPx: number;
  let toolPx: number;

  beforeEach(() => {
    drag = new Drag();
    nowMs = 1000;
    pointerPx = toolPx = 0;
    drag.begin(step(0), nowMs);
  });

  /** Lets time pass under a force, while the pointer moves. The tool never turns back or passes it. */
  function pass(ms: number, share: number, pxPerMs: number, tickMs = TICK_MS): void {
    for (const end = nowMs + ms; nowMs < end;) {
      nowMs += tickMs;
      pointerPx += pxPerMs * tickMs;
      if (pxPerMs > 0) drag.pull(step(pointerPx));
      for (const { place, pose } of drag.follow(share, nowMs)) {
        expect(place.x).toBeGreaterThanOrEqual(toolPx - 1e-9);
        expect(place.x).toBeLessThanOrEqual(pointerPx + 1e-9);
        expect(pose.tip[0]).toBeCloseTo(place.x / PX_PER_MM);
        toolPx = place.x;
      }
      expect(drag.lagPx).toBeCloseTo(pointerPx - toolPx);
    }
  }

  it('is none without force, and none that is off', () => {
    drag.strength = 'strong';
    pass(200, 0, 1);
    expect(toolPx).toBe(pointerPx);
    drag.strength = 'off';
    pass(200, 1, 1);
    expect(toolPx).toBe(pointerPx);
  });

  it.each([
    ['light', 80],
    ['strong', 300],
  ] as [DragStrength, number][])('is %s: speed times time constant behind', (strength, mostMs) => {
    drag.strength = strength;
    for (const share of [1, 0.5]) {
      pass(3000, share, 0.2);
      // In ticks the tool is up to one behind.
      const lag = 0.2 * mostMs * share;
      expect(drag.lagPx).toBeGreaterThan(lag - 0.2 * TICK_MS);
      expect(drag.lagPx).toBeLessThan(lag + 0.2 * TICK_MS);
    }
  });

  it('never lags by more than the spring is long', () => {
    drag.strength = 'light';
    pass(2000, 1, 5);
    expect(drag.lagPx).toBeCloseTo(30);
    drag.strength = 'strong';
    pass(2000, 1, 5);
    expect(drag.lagPx).toBeCloseTo(120);
  });

  it('catches up when the force ends, and when the pointer rests', () => {
    drag.strength = 'strong';
    pass(2000, 1, 0.3);
    expect(drag.lagPx).toBeGreaterThan(80);
    pass(200, 0, 0);
    expect(drag.lagPx).toBe(0);
    pass(2000, 1, 0.3);
    pass(3000, 1, 0);
    expect(drag.lagPx).toBe(0);
  });

  it('goes the same path whatever the times of the ticks', () => {
    drag.strength = 'strong';
    for (const tickMs of [1, 4, 16, 50]) {
      drag.begin(step(0), nowMs);
      pointerPx = toolPx = 0;
      pass(1000, 1, 0); // the force is steady
      pointerPx = 100;
      drag.pull(step(100));
      pass(300, 1, 0, tickMs);
      expect(toolPx).toBeCloseTo(
        100 * (1 - Math.exp(-Math.ceil(300 / tickMs) * (tickMs / 300))),
        1,
      );
    }
  });

  it('does not oscillate when the force follows the speed of the tool', () => {
    drag.strength = 'strong';
    let before = 0;
    for (let n = 0; n < 500; ++n) {
      const speed = (toolPx - before) / TICK_MS;
      before = toolPx;
      pass(TICK_MS, Math.min(1, speed / 0.2), 0.2); // checks that it only goes on
    }
    const lags: number[] = [];
    for (let n = 0; n < 100; ++n) {
      const speed = (toolPx - before) / TICK_MS;
      before = toolPx;
      pass(TICK_MS, Math.min(1, speed / 0.2), 0.2);
      lags.push(drag.lagPx);
    }
    expect(Math.max(...lags) - Math.min(...lags)).toBeLessThan(1);
  });

  it('leaves nothing of the path out', () => {
    drag.strength = 'strong';
    pass(500, 1, 0);
    const steps: DragStep[] = [];
    for (const px of [10, 20, 30]) drag.pull(step(px));
    for (let n = 0; n < 400; ++n) steps.push(...drag.follow(1, (nowMs += TICK_MS)));
    for (const px of [10, 20, 30]) expect(steps.some(({ place }) => place.x === px)).toBe(true);
  });
});
