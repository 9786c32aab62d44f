// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { CameraMarks } from '../src/view/camera_marks';
import type { Viewer } from '../src/view/viewer';
import type { ShownCamera } from '../src/wire/types';
import { FakeElement, stubPage } from './support/fake_dom';

beforeEach(() => stubPage());
afterEach(() => vi.unstubAllGlobals());

const ada: ShownCamera = {
  participant: 4,
  name: 'Ada',
  color: '#112233',
  eye_mm: [0, -100, 50],
  target_mm: [0, 0, 0],
  parallel: false,
};

it('shown cameras draw the picture again when they move, come or go, and not else', () => {
  let draws = 0;
  const scene = new THREE.Scene();
  const viewer = { layers: new Set(), stage: { scene }, touch: () => (draws += 1) };
  const overlay = new FakeElement() as unknown as HTMLElement;
  const marks = new CameraMarks(viewer as unknown as Viewer, overlay);
  const show = (cameras: readonly ShownCamera[]): number => {
    const before = draws;
    marks.show(cameras);
    return draws - before;
  };
  expect([show([]), show([])]).toEqual([0, 0]);
  expect([show([ada]), show([{ ...ada }])]).toEqual([1, 0]);
  expect(scene.children).toHaveLength(1);
  expect(show([{ ...ada, eye_mm: [0, -90, 50] }])).toBe(1);
  expect([show([]), show([])]).toEqual([1, 0]);
  expect(scene.children).toHaveLength(0);
});
