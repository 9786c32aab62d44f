// SPDX-License-Identifier: Apache-2.0
// Where the shadow of a block falls on the ground.

import * as THREE from 'three';

/**
 * The rectangle on the plane z = `groundZ` that holds the shadow of a box.
 * @param light direction towards the light, with z > 0
 */
export function shadowOnGround(box: THREE.Box3, light: THREE.Vector3, groundZ: number): THREE.Box2 {
  const area = new THREE.Box2();
  for (const x of [box.min.x, box.max.x])
    for (const y of [box.min.y, box.max.y])
      for (const z of [box.min.z, box.max.z]) {
        const steps = (z - groundZ) / light.z;
        area.expandByPoint(new THREE.Vector2(x - steps * light.x, y - steps * light.y));
      }
  return area;
}
