// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { PointerPath } from '../../src/carve/pointer_path';
import type { Place } from '../../src/carve/place';

const at = (
  x: number,
  y: number,
  pressure: number | null = null,
  tilt: Place['tilt'] = null,
): Place => ({ x, y, pressure, tilt });

function trace(events: readonly Place[]): Place[] {
  const path = new PointerPath(events[0]!);
  const places = events.slice(1).flatMap((event) => path.to(event));
  return [events[0]!, ...places, ...path.end()];
}

/** The largest angle between neighboring pieces of a path, rad. */
function sharpest(places: readonly Place[]): number {
  let most = 0;
  for (let n = 2; n < places.length; ++n) {
    const [a, b, c] = [places[n - 2]!, places[n - 1]!, places[n]!];
    const turn = Math.atan2(c.y - b.y, c.x - b.x) - Math.atan2(b.y - a.y, b.x - a.x);
    most = Math.max(most, Math.abs(Math.atan2(Math.sin(turn), Math.cos(turn))));
  }
  return most;
}

describe('path of a pointer', () => {
  it('makes small steps of a jump, up to where the pointer is', () => {
    const places = trace([at(0, 0), at(30, 0), at(60, 0)]);
    for (let n = 1; n < places.length; ++n) {
      const step = places[n]!.x - places[n - 1]!.x;
      expect(step).toBeGreaterThan(0);
      expect(step).toBeLessThan(8);
      expect(places[n]!.y).toBe(0);
    }
    expect(places.at(-1)).toEqual(at(60, 0));
  });

  it('is round where a fast circle has few events', () => {
    // Twelve events a turn on a circle of 100 pixels: chords would bend by 30 degrees.
    const events = Array.from({ length: 13 }, (_, n) =>
      at(100 * Math.cos((n * Math.PI) / 6), 100 * Math.sin((n * Math.PI) / 6)),
    );
    const places = trace(events);
    expect(sharpest(events)).toBeCloseTo(Math.PI / 6);
    expect(sharpest(places)).toBeLessThan(0.08);
    for (const { x, y } of places.slice(20, -20)) {
      expect(Math.abs(Math.hypot(x, y) - 98)).toBeLessThan(2.5);
    }
  });

  it('ends once, and goes on from there', () => {
    const path = new PointerPath(at(0, 0));
    expect(path.end()).toEqual([]);
    path.to(at(20, 0));
    expect(path.end().at(-1)).toEqual(at(20, 0));
    expect(path.end()).toEqual([]);
    const next = path.to(at(40, 0));
    expect(next.at(-1)).toEqual(at(30, 0));
    expect(next.every(({ x }) => x > 20)).toBe(true);
  });

  it('has few steps, however far the pointer jumps', () => {
    const path = new PointerPath(at(0, 0));
    expect(path.to(at(5000, 0))).toHaveLength(16);
  });

  it('changes pressure evenly', () => {
    const places = trace([at(0, 0, 0.2), at(40, 0, 1), at(80, 0, 1)]);
    const pressures = places.map(({ pressure }) => pressure!);
    expect(pressures).toEqual([...pressures].sort((a, b) => a - b));
    expect(pressures.at(-1)).toBe(1);
    expect(trace([at(0, 0), at(40, 0)]).every(({ pressure }) => pressure === null)).toBe(true);
  });

  it('turns a pen evenly', () => {
    const places = trace([
      at(0, 0, 1, [0.2, 0]),
      at(40, 0, 1, [0.4, -0.2]),
      at(80, 0, 1, [0.4, -0.2]),
    ]);
    const lean = places.map(({ tilt }) => tilt![0]);
    expect(lean).toEqual([...lean].sort((a, b) => a - b));
    expect(new Set(lean).size).toBeGreaterThan(5);
    for (const { tilt } of places) expect(tilt![1]).toBeCloseTo(0.2 - tilt![0]);
  });
});
