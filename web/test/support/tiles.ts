// SPDX-License-Identifier: Apache-2.0
// A block of 5 x 5 tiles with a surface of given heights, as the page displays one.

import * as THREE from 'three';
import { ORIGINAL_ATTRIBUTE } from '../../src/view/parsed_tiles';
import type { ParsedTile } from '../../src/view/parsed_tiles';
import { TileView } from '../../src/view/tile_view';
import type { Welcome } from '../../src/wire/types';

export const SIDE = 8;
export const TILES = 5;
export const WELCOME = {
  pitch_mm: 0.25,
  grid: { origin_mm: [-20, -20, -12], columns: [160, 160], tile: 32 },
  stock: { shape: 'box', min_mm: [-20, -20, -12], max_mm: [20, 20, 0] },
} as unknown as Welcome;

/** A tile with a surface of heights at a raster, quantized as the server's are. */
export function tileOf(x: number, y: number, height: (x: number, y: number) => number): ParsedTile {
  const raster = 8;
  const geometry = new THREE.BufferGeometry();
  const words: number[] = [];
  for (let j = 0; j <= raster; ++j)
    for (let i = 0; i <= raster; ++i) {
      const [u, v] = [(i * SIDE) / raster, (j * SIDE) / raster];
      words.push(u * 1000, v * 1000, height(-20 + x * SIDE + u, -20 + y * SIDE + v) * 1000);
    }
  geometry.setAttribute('position', new THREE.BufferAttribute(new Int16Array(words), 3));
  const vertices = words.length / 3;
  const up = Array.from({ length: vertices }, () => [0, 0, 127]).flat();
  geometry.setAttribute('normal', new THREE.BufferAttribute(new Int8Array(up), 3, true));
  const original = new THREE.BufferAttribute(new Int8Array(vertices), 1);
  geometry.setAttribute(ORIGINAL_ATTRIBUTE, original);
  const index: number[] = [];
  for (let j = 0; j < raster; ++j)
    for (let i = 0; i < raster; ++i) {
      const a = j * (raster + 1) + i;
      index.push(a, a + 1, a + raster + 2, a, a + raster + 2, a + raster + 1);
    }
  geometry.setIndex(index);
  const matrix = new THREE.Matrix4()
    .makeTranslation(-20 + x * SIDE, -20 + y * SIDE, 0)
    .scale(new THREE.Vector3(0.001, 0.001, 0.001));
  return {
    x,
    y,
    columns: 1,
    rows: 1,
    version: 1,
    level: 0,
    motions: 0,
    triangles: 128,
    geometry,
    matrix,
  };
}

export function block(height: (x: number, y: number) => number): TileView {
  const view = new TileView(new THREE.MeshBasicMaterial());
  for (let y = 0; y < TILES; ++y)
    for (let x = 0; x < TILES; ++x) view.set(tileOf(x, y, height), x, y, SIDE);
  return view;
}
