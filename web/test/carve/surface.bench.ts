// SPDX-License-Identifier: Apache-2.0
// Rays against a carved block of 2,048 x 2,048 columns. Run by `npx vitest bench --run`.

import * as THREE from 'three';
import { bench, describe } from 'vitest';
import { Aim } from '../../src/carve/aim';
import { Surface } from '../../src/carve/surface';
import type { Ray } from '../../src/carve/surface';
import { unitOf } from '../../src/model/vector';
import { toolProfile } from '../../src/model/tool_profile';
import { DisplayedSurface } from '../../src/view/displayed_surface';
import type { DisplayedTile, TileView } from '../../src/view/tile_view';
import type { Vec3 } from '../../src/wire/types';

const TILES = 64;
const CELLS = 32;
const PITCH = 0.1;
const SIDE = CELLS * PITCH;
function tile(x: number, y: number): DisplayedTile {
  const words = new Int16Array(3 * (CELLS + 1) ** 2);
  const index: number[] = [];
  for (let j = 0; j <= CELLS; ++j)
    for (let i = 0; i <= CELLS; ++i) {
      const [u, v] = [i * PITCH, j * PITCH];
      const height = 4 * Math.sin((x * SIDE + u) / 5) * Math.cos((y * SIDE + v) / 7) - 6;
      words.set([u * 1000, v * 1000, height * 1000], 3 * (j * (CELLS + 1) + i));
      if (i === CELLS || j === CELLS) continue;
      const a = j * (CELLS + 1) + i;
      index.push(a, a + 1, a + CELLS + 2, a, a + CELLS + 2, a + CELLS + 1);
    }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(words, 3));
  geometry.setIndex(index);
  const matrix = new THREE.Matrix4()
    .makeTranslation(x * SIDE, y * SIDE, 0)
    .scale(new THREE.Vector3(0.001, 0.001, 0.001));
  return { key: y * 65536 + x, geometry, matrix };
}

describe('a block of 4,194,304 columns', () => {
  const tiles = Array.from({ length: TILES * TILES }, (_, n) =>
    tile(n % TILES, Math.floor(n / TILES)),
  );
  const view = { changes: 0, tiles: () => tiles };
  const displayed = new DisplayedSurface(view as unknown as TileView);
  const surface = new Surface(displayed.pieces);
  const profile = toolProfile({ id: 1, shape: 'ball', diameter_mm: 6, length_mm: 30 });
  const bounds = { min: [0, 0, -30] as Vec3, max: [205, 205, 0] as Vec3 };
  const aim = new Aim(profile, bounds, { mode: 'surface', depthMm: 1, axis: 'surface' });
  let n = 0;
  /** From the default camera to places of the block, one after another. */
  const next = (): Ray => {
    n = (n + 1) % 500;
    const target: Vec3 = [20 + 0.33 * n, 100 + 60 * Math.sin(n / 40), -6];
    const origin: Vec3 = [-150, -300, 500];
    return { origin, direction: unitOf([0, 1, 2].map((i) => target[i]! - origin[i]!) as Vec3) };
  };
  bench('the tiles of a stroke', () => {
    view.changes += 1; // all are as before
    new Surface(displayed.pieces);
  });
  bench('a ray', () => void surface.hit(next()));
  bench('a pose', () => void aim.hover(surface, next()));
});
