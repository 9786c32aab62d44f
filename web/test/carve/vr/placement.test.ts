// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import { describe, expect, it } from 'vitest';
import { Placement } from '../../../src/carve/vr/placement';
import type { Grip } from '../../../src/carve/vr/placement';

const BLOCK = { min: [-20, -15, -10], max: [20, 15, 0] } as const;

function grip(x: number, y: number, z: number, turn = new THREE.Quaternion()): Grip {
  return { position: new THREE.Vector3(x, y, z), quaternion: turn };
}

function standing(): Placement {
  const placement = new Placement();
  placement.stand({ min: [...BLOCK.min], max: [...BLOCK.max] });
  return placement;
}

function inPhysical(placement: Placement, ...mm: [number, number, number]): THREE.Vector3 {
  return new THREE.Vector3(...mm).applyMatrix4(placement.toPhysical);
}

function expectAt(point: THREE.Vector3, x: number, y: number, z: number): void {
  expect(point.distanceTo(new THREE.Vector3(x, y, z))).toBeLessThan(1e-12);
}

describe('Placement', () => {
  it('stands a block of any size on a table, its Z up', () => {
    const placement = standing();
    const [foot, top] = [inPhysical(placement, 0, 0, -10), inPhysical(placement, 0, 0, 0)];
    expectAt(foot, 0, 0.9, -0.55);
    expectAt(top.sub(foot), 0, 10 * placement.scale, 0);
    expect(40 * placement.scale).toBeCloseTo(0.45, 12);
    // Its front, -Y, faces the user.
    expect(inPhysical(placement, 0, -15, 0).z).toBeGreaterThan(inPhysical(placement, 0, 15, 0).z);
  });

  it('moves with one hand, and turns with it about it', () => {
    const placement = standing();
    const before = inPhysical(placement, 20, 0, 0);
    placement.hold([null, grip(0.1, 1, -0.3)]);
    expectAt(inPhysical(placement, 20, 0, 0), before.x, before.y, before.z);
    const quarter = new THREE.Quaternion().setFromAxisAngle(
      new THREE.Vector3(0, 1, 0),
      Math.PI / 2,
    );
    placement.hold([null, grip(0.3, 1.2, -0.3, quarter)]);
    // (dx, dz) from the hand becomes (dz, -dx).
    const [dx, dz] = [before.x - 0.1, before.z + 0.3];
    expectAt(inPhysical(placement, 20, 0, 0), 0.3 + dz, before.y + 0.2, -0.3 - dx);
  });

  it('keeps the held points under both hands when they scale and turn it', () => {
    const placement = standing();
    const held = [inPhysical(placement, -20, 0, 0), inPhysical(placement, 20, 0, 0)] as const;
    const { scale } = placement;
    placement.hold(held.map(({ x, y, z }) => grip(x, y, z)));
    for (let step = 1; step <= 10; step += 1) {
      const reach = 0.1 * step;
      placement.hold([grip(-reach, 1, -0.5 - reach), grip(reach, 1.3, -0.5 + reach)]);
    }
    expectAt(inPhysical(placement, -20, 0, 0), -1, 1, -1.5);
    expectAt(inPhysical(placement, 20, 0, 0), 1, 1.3, 0.5);
    expect(placement.scale / scale).toBeCloseTo(Math.hypot(2, 0.3, 2) / 0.45, 9);
  });

  it('does not jump when a second hand comes, and one goes', () => {
    const placement = standing();
    const at = (): THREE.Vector3 => inPhysical(placement, 3, 4, -5);
    const before = at();
    placement.hold([grip(0, 1, 0), null]);
    placement.hold([grip(0, 1, 0), grip(1, 1, 0)]);
    placement.hold([null, grip(1, 1, 0)]);
    placement.hold([null, null]);
    placement.hold([grip(5, 5, 5), null]);
    expectAt(at(), before.x, before.y, before.z);
  });

  it('stops at the greatest and the least scale', () => {
    const placement = standing();
    placement.hold([grip(0, 1, 0), grip(0.02, 1, 0)]);
    placement.hold([grip(0, 1, 0), grip(1000, 1, 0)]);
    expect(placement.scale).toBeCloseTo(1, 12);
    placement.hold([grip(0, 1, 0), grip(0.1, 1, 0)]);
    for (let n = 0; n < 12; n += 1)
      placement.hold([grip(0, 1, 0), grip(n % 2 === 0 ? 0.011 : 0.1, 1, 0)]);
    expect(placement.scale).toBeLessThanOrEqual(1 + 1e-12);
    placement.hold([null, null]);
    for (let n = 0; n < 12; n += 1) {
      placement.hold([grip(0, 1, 0), grip(1, 1, 0)]);
      placement.hold([grip(0, 1, 0), grip(0.02, 1, 0)]);
      placement.hold([null, null]);
    }
    expect(placement.scale).toBeCloseTo(1e-5, 15);
  });
});
