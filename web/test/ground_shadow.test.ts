// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import { describe, expect, it } from 'vitest';
import { shadowOnGround } from '../src/view/ground_shadow';

const box = new THREE.Box3(new THREE.Vector3(-10, -5, 0), new THREE.Vector3(10, 5, 8));

describe('shadowOnGround', () => {
  it('is the foot of a box under a light that stands above it', () => {
    const { min, max } = shadowOnGround(box, new THREE.Vector3(0, 0, 3), 0);
    expect([min.toArray(), max.toArray()]).toEqual([
      [-10, -5],
      [10, 5],
    ]);
  });

  it('reaches away from the light by the height above the ground', () => {
    const { min, max } = shadowOnGround(box, new THREE.Vector3(-1, 0.5, 1), -2);
    expect([min.toArray(), max.toArray()]).toEqual([
      [-10 + 2, -5 - 5],
      [10 + 10, 5 - 1],
    ]);
  });

  it('holds the shadow of each point of the box', () => {
    const light = new THREE.Vector3(0.3, -0.7, 0.4);
    const area = shadowOnGround(box, light, -1);
    for (let n = 0; n < 100; n += 1) {
      const part = new THREE.Vector3((n % 5) / 4, (((n / 5) | 0) % 5) / 4, ((n / 25) | 0) / 3);
      const point = part.multiply(box.getSize(new THREE.Vector3())).add(box.min);
      const ray = new THREE.Ray(point, light.clone().negate().normalize());
      const hit = ray.intersectPlane(
        new THREE.Plane(new THREE.Vector3(0, 0, 1), 1),
        new THREE.Vector3(),
      )!;
      expect(area.distanceToPoint(new THREE.Vector2(hit.x, hit.y))).toBeLessThan(1e-9);
    }
  });
});
