// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import { describe, expect, it } from 'vitest';
import type { Viewport } from '../src/model/fit';
import { firstLook, viewBounds } from '../src/model/first_look';
import { boxCenter } from '../src/model/fit';
import { posterPlace } from '../src/model/poster_place';
import { stockBounds } from '../src/model/session';
import type { Vec3, Welcome } from '../src/wire/types';

type Box = [left: number, top: number, right: number, bottom: number];

const DIRECTION = new THREE.Vector3(-0.45, -1, 1.42).normalize();

function blockOf(max_mm: Vec3): Welcome {
  return {
    type: 'welcome',
    session: 'demo',
    participant: 9,
    epoch: 1,
    color: '#888888',
    pitch_mm: 0.5,
    pivot_mm: 60,
    stock: { shape: 'box', min_mm: [0, 0, -20], max_mm },
    tools: [{ id: 4, shape: 'ball', diameter_mm: 6, length_mm: 30 }],
    participants: [],
    grid: { origin_mm: [0, 0, 0], columns: [2, 2], tile: 32 },
  };
}

/** Where a camera shows the block, CSS pixels of a picture of this size. */
function shown(welcome: Welcome, camera: THREE.Camera, width: number, height: number): Box {
  const { min, max } = stockBounds(welcome.stock);
  const box: Box = [Infinity, Infinity, -Infinity, -Infinity];
  for (let n = 0; n < 8; ++n) {
    const at = (c: 0 | 1 | 2): number => ((n >> c) & 1 ? max[c] : min[c]);
    const p = new THREE.Vector3(at(0), at(1), at(2)).project(camera);
    const [x, y] = [((1 + p.x) / 2) * width, ((1 - p.y) / 2) * height];
    box[0] = Math.min(box[0], x);
    box[1] = Math.min(box[1], y);
    box[2] = Math.max(box[2], x);
    box[3] = Math.max(box[3], y);
  }
  return box;
}

function cameraAt(eye: THREE.Vector3, target: Vec3, aspect: number): THREE.PerspectiveCamera {
  const camera = new THREE.PerspectiveCamera(30, aspect, 1, 5000);
  camera.up.set(0, 0, 1);
  camera.position.copy(eye);
  camera.lookAt(new THREE.Vector3(...target));
  camera.updateMatrixWorld();
  return camera;
}

/** The page's own picture: the camera of the default view, shifted by the panels. */
function inPage(welcome: Welcome, { width, height, insets }: Viewport): Box {
  const { look } = firstLook(welcome, { width, height, insets }, 0);
  const target = boxCenter(viewBounds(welcome));
  const camera = cameraAt(new THREE.Vector3(...look.eye_mm), target, width / height);
  const { left, right, top, bottom } = insets;
  camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
  return shown(welcome, camera, width, height);
}

/** The server's picture, as server/picture/picture_camera.cpp describes it, 4:3. */
function inPoster(welcome: Welcome, left: number, top: number, width: number): Box {
  const height = (width * 3) / 4;
  const center = boxCenter(stockBounds(welcome.stock));
  // The nearest place from which the whole block is in the picture, and 3 % more.
  const cameraFrom = (far: number): THREE.PerspectiveCamera =>
    cameraAt(new THREE.Vector3(...center).addScaledVector(DIRECTION, far), center, 4 / 3);
  let [near, far] = [50, 5000];
  for (let n = 0; n < 60; ++n) {
    const middle = (near + far) / 2;
    const [x0, y0, x1, y1] = shown(welcome, cameraFrom(middle), 4, 3);
    if (x0 >= 0 && y0 >= 0 && x1 <= 4 && y1 <= 3) far = middle;
    else near = middle;
  }
  const box = shown(welcome, cameraFrom(1.03 * far), width, height);
  return box.map((value, n) => value + (n % 2 === 0 ? left : top)) as Box;
}

describe('poster place', () => {
  const views: Viewport[] = [
    { width: 1440, height: 900, insets: { left: 68, right: 348, top: 60, bottom: 24 } },
    { width: 390, height: 844, insets: { left: 0, right: 0, top: 60, bottom: 400 } },
    { width: 900, height: 500, insets: { left: 0, right: 0, top: 0, bottom: 0 } },
  ];
  const sizes: Vec3[] = [
    [100, 60, 0],
    [40, 200, 0],
    [60, 60, 100],
  ];

  it.each(sizes)('covers the block of the page: %d × %d × %d', (...size) => {
    const welcome = blockOf(size);
    for (const view of views) {
      const { left, top, width } = posterPlace(welcome, view);
      const [page, poster] = [inPage(welcome, view), inPoster(welcome, left, top, width)];
      const across = page[2] - page[0];
      page.forEach((side, n) => {
        expect(Math.abs(side - poster[n]!) / across).toBeLessThan(0.05);
      });
    }
  });
});
