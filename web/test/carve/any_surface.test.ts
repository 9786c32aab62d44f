// SPDX-License-Identifier: Apache-2.0
// Any point of a solid that can be seen from one of six sides is cut there to the chosen depth, with
// the hand of the page and the real kernel. KERF_POINTS: how many points of each solid.

import * as THREE from 'three';
import { existsSync } from 'node:fs';
import { describe, expect, it, vi } from 'vitest';
import { Hand } from '../../src/carve/hand';
import type { Draft } from '../../src/carve/sample_log';
import { cornerOf, normalOf } from '../../src/model/surface';
import { cross, distance, dot, minus, plus, scaled, unitOf } from '../../src/model/vector';
import type { Viewer } from '../../src/view/viewer';
import type { ToolInfo, Vec3, Welcome } from '../../src/wire/types';
import { KERNEL_FILE, KernelBlock } from '../support/kernel_block';
import type { Solid } from '../support/kernel_block';

const POINTS = Number(process.env['KERF_POINTS'] ?? 30);
const PITCH = 0.5;
const BOX = { min: [-20, -20, -24] as Vec3, max: [20, 20, 24] as Vec3 };
const BALL: ToolInfo = { id: 1, shape: 'ball', diameter_mm: 4, length_mm: 20 };
const DEPTH_MM = 1;
const VIEWS: Vec3[] = [
  [1, 0, 0],
  [-1, 0, 0],
  [0, 1, 0],
  [0, -1, 0],
  [0, 0, 1],
  [0, 0, -1],
];
const SOLIDS: Record<string, Solid[]> = {
  sphere: [{ kind: 'ellipsoid', center: [0, 0, 0], radii: [18, 18, 18] }],
  cylinder: [{ kind: 'cylinder', center: [0, 0, 0], radii: [15, 15, 20] }],
  bust: [
    { kind: 'ellipsoid', center: [0, 0, 9], radii: [9, 11, 13] }, // the head
    { kind: 'ellipsoid', center: [0, -11, 8], radii: [2, 3, 4] }, // the nose
    { kind: 'ellipsoid', center: [9, 0, 8], radii: [2, 3, 4] }, // the ears
    { kind: 'ellipsoid', center: [-9, 0, 8], radii: [2, 3, 4] },
    { kind: 'cylinder', center: [0, 1, -7], radii: [5.5, 6, 8] }, // the neck
    { kind: 'ellipsoid', center: [0, 0, -18], radii: [18, 10, 6] }, // the shoulders
  ],
};

/** Numbers of [0, 1) from a seed (Mulberry32). */
function randomOf(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** Random places of the surface, in proportion to area. */
function placesOf(block: KernelBlock, random: () => number): { point: Vec3; normal: Vec3 }[] {
  const triangles = block.pieces.flatMap((piece) => {
    const corners = piece.corners();
    return Array.from({ length: corners.length / 9 }, (_, n) => ({ corners, at: 9 * n }));
  });
  let sum = 0;
  const sums = triangles.map(({ corners, at }) => {
    const [a, b, c] = [0, 3, 6].map((n) => cornerOf(corners, at + n)) as [Vec3, Vec3, Vec3];
    return (sum += Math.hypot(...cross(minus(b, a), minus(c, a))));
  });
  return Array.from({ length: POINTS }, () => {
    const wanted = random() * sum;
    const { corners, at } = triangles[sums.findIndex((one) => one > wanted)]!;
    const [a, b, c] = [0, 3, 6].map((n) => cornerOf(corners, at + n)) as [Vec3, Vec3, Vec3];
    const [u, v] = [Math.sqrt(random()), random()];
    const point = plus(plus(scaled(a, 1 - u), b, u * (1 - v)), c, u * v);
    return { point, normal: normalOf(corners, at) };
  });
}

/** The hand before a block, seen from a side: places are millimeters from a point in the picture. */
function handOf(block: KernelBlock, view: { from: Vec3; at: Vec3 }): Hand {
  const displayed = {
    changes: 0,
    get pieces() {
      return block.pieces;
    },
    forget: vi.fn(),
  };
  const direction = scaled(view.from, -1);
  const viewer = {
    ...{ displayed, stage: { scene: new THREE.Scene() }, touchAll: vi.fn() },
    ray: () =>
      new THREE.Ray(
        new THREE.Vector3(...plus(view.at, view.from, 100)),
        new THREE.Vector3(...direction),
      ),
  };
  const hand = new Hand(viewer as unknown as Viewer, vi.fn());
  hand.sampler.limits = { speedMmPerS: 5000, samplesPerS: 1250 };
  const welcome = {
    stock: { shape: 'box', min_mm: BOX.min, max_mm: BOX.max },
    pitch_mm: PITCH,
    grid: { origin_mm: BOX.min, columns: [80, 80], tile: 32 },
  };
  hand.takeTool(BALL, '#d9541e', welcome as unknown as Welcome);
  return hand;
}

function samplesOf(hand: Hand): Draft[] {
  const all: Draft[] = [];
  for (let n = 1; n < 20; n += 1) all.push(...hand.sampler.take(n * 20_000));
  return all;
}

describe.skipIf(!existsSync(KERNEL_FILE))('a pointer', () => {
  it.each(Object.keys(SOLIDS))(
    'cuts a %s anywhere to its depth',
    async (name) => {
      const block = await KernelBlock.of({
        ...{ box: BOX, pitch: PITCH, tools: [BALL] },
        solids: SOLIDS[name]!,
      });
      const { surface } = block;
      const whole = block.hash;
      let [good, seen, sum] = [0, 0, 0];
      for (const { point, normal } of placesOf(block, randomOf(48))) {
        let least = Infinity;
        for (const from of VIEWS) {
          if (least <= PITCH || dot(from, normal) < 0.05) continue;
          const ray = { origin: plus(point, from, 100), direction: scaled(from, -1) };
          const hit = surface.hit(ray);
          if (!hit || distance(hit.point, point) > 1e-3) continue;
          const hand = handOf(block, { from, at: point });
          expect(hand.begin({ x: 0, y: 0, pressure: null, tilt: null }, DEPTH_MM)).toBe('');
          hand.end(DEPTH_MM);
          block.cut(samplesOf(hand));
          // Inwards from the untouched surface to the one that is left.
          const inwards = unitOf(scaled(surface.smoothNormal(hit, [], 1), -1));
          const left = block.surface.hit({
            origin: plus(point, inwards, -1e-3),
            direction: inwards,
          });
          least = Math.min(least, Math.abs((left?.at ?? Infinity) - DEPTH_MM));
          block.reset();
          expect(block.hash).toBe(whole);
        }
        if (least === Infinity) continue; // not to be seen from any side
        seen += 1;
        sum += Math.min(least, DEPTH_MM);
        if (least <= PITCH) good += 1;
      }
      const meanMm = (sum / seen).toFixed(3);
      console.info(
        `${name}: ${good} of ${seen} places cut to ${DEPTH_MM} ± ${PITCH} mm; mean error ${meanMm} mm`,
      );
      expect(seen).toBeGreaterThan(0.9 * POINTS);
      expect(good).toBeGreaterThanOrEqual(0.99 * seen);
    },
    1_200_000,
  );
});
