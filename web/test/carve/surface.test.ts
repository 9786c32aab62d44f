// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import { describe, expect, it } from 'vitest';
import { Surface } from '../../src/carve/surface';
import type { Ray } from '../../src/carve/surface';
import { tileAt, tileKey } from '../../src/model/tiles';
import { DisplayedSurface } from '../../src/view/displayed_surface';
import type { TileView } from '../../src/view/tile_view';
import type { Vec3 } from '../../src/wire/types';
import { block, SIDE, tileOf, TILES } from '../support/tiles';

function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

function surfaceOf(view: TileView): Surface {
  return new Surface(new DisplayedSurface(view).pieces);
}

const bumpy = (x: number, y: number): number => -4 + 3 * Math.sin(x / 3) * Math.cos(y / 4);

/** Steep enough that a ray meets several fronts in one tile. */
const grooved = (x: number, y: number): number => -6 + 5 * Math.sin(2.2 * x + 0.3 * y);

describe('surface', () => {
  it('keeps the corners of its tiles until it forgets them', () => {
    const displayed = new DisplayedSurface(block(() => -2));
    const known = displayed.pieces[0]!.corners();
    expect(displayed.pieces[0]!.corners()).toBe(known);
    displayed.forget();
    expect(displayed.pieces[0]!.corners()).not.toBe(known);
    expect(displayed.pieces[0]!.corners()).toEqual(known);
  });

  it.each([bumpy, grooved])('hits the points that three.js hits', (height) => {
    const view = block(height);
    const surface = surfaceOf(view);
    const next = random(7);
    const caster = new THREE.Raycaster();
    let met = 0;
    for (let n = 0; n < 400; ++n) {
      const origin = new THREE.Vector3(80 * next() - 40, 80 * next() - 40, 2 + 60 * next());
      const target = new THREE.Vector3(50 * next() - 25, 50 * next() - 25, -12 * next());
      const direction = target.clone().sub(origin).normalize();
      caster.set(origin, direction);
      const expected = view.pick(caster);
      const hit = surface.hit({ origin: origin.toArray(), direction: direction.toArray() });
      expect(hit !== null).toBe(expected !== null);
      if (!hit || !expected) continue;
      met += 1;
      expect(new THREE.Vector3(...hit.point).distanceTo(expected)).toBeLessThan(1e-3);
      expect(Math.hypot(...hit.normal)).toBeCloseTo(1);
      expect(hit.at).toBeCloseTo(origin.distanceTo(expected), 2);
    }
    expect(met).toBeGreaterThan(150);
  });

  it('is hit by rays along the axes, in the sides of tiles, too', () => {
    const surface = surfaceOf(block(() => -2));
    for (const x of [-20, -12, -4, 0.3, 12, 20]) {
      const ray: Ray = { origin: [x, -12, 30], direction: [0, 0, -1] };
      const hit = surface.hit(ray)!;
      expect(hit.normal).toEqual([0, 0, 1]);
      expect(hit.point[2]).toBeCloseTo(-2);
    }
    expect(surface.hit({ origin: [0, 0, 30], direction: [0, 0, 1] })).toBeNull();
    expect(surface.hit({ origin: [0, 0, 30], direction: [0, 0, -1] }, 31)).toBeNull();
    // From below it is the back of the surface.
    expect(surface.hit({ origin: [0, 0, -30], direction: [0, 0, 1] })).toBeNull();
  });

  it('stays as it was when the block is cut', () => {
    const view = block(() => -1);
    const frozen = surfaceOf(view);
    const ray: Ray = { origin: [1, 1, 30], direction: [0, 0, -1] };
    const { changes } = view;
    expect(changes).toBe(TILES * TILES);
    view.set(
      tileOf(2, 2, () => -5),
      2,
      2,
      SIDE,
    );
    expect(view.changes).not.toBe(changes);
    expect(frozen.hit(ray)!.point[2]).toBeCloseTo(-1);
    expect(surfaceOf(view).hit(ray)!.point[2]).toBeCloseTo(-5);
  });

  it('averages the normal over places around a hit', () => {
    const ridges = surfaceOf(block((x) => -2 + (Math.round(x) % 2 === 0 ? 0.2 : -0.2)));
    const around: Vec3[] = Array.from({ length: 6 }, (_, n) => [
      Math.cos((n * Math.PI) / 3),
      Math.sin((n * Math.PI) / 3),
      0,
    ]);
    const hit = ridges.hit({ origin: [0.5, 0.3, 30], direction: [0, 0, -1] })!;
    expect(hit.normal[2]).toBeLessThan(0.95);
    expect(ridges.smoothNormal(hit, around, 1.5)[2]).toBeGreaterThan(hit.normal[2]);
    const level = surfaceOf(block(() => -2));
    const flat = level.hit({ origin: [-20, 0, 30], direction: [0, 0, -1] })!; // half misses
    expect(level.smoothNormal(flat, around, 2)).toEqual([0, 0, 1]);
  });

  it('knows the place of a tile from its key', () => {
    expect(tileAt(tileKey(3, 700))).toEqual([3, 700]);
  });
});
