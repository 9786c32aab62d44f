// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import { describe, expect, it } from 'vitest';
import { reachesAll } from '../src/model/reach';
import { rotated } from '../src/model/vector';
import { ReachView } from '../src/view/reach_view';
import type { Reach } from '../src/wire/reach';
import type { Vec3 } from '../src/wire/types';

const stock = { min: [-50, -30, -20] as Vec3, max: [50, 30, 0] as Vec3 };

function reach(fields: Partial<Reach> = {}): Reach {
  return {
    center_mm: [0, 0, -10],
    half_mm: [60, 40, 40],
    turn_rad: [0, 0, 0],
    scale: 1,
    ...fields,
  };
}

describe('the box that a device reaches', () => {
  it('turns as a rotation vector does', () => {
    const [x, y, z] = rotated([1, 0, 0], [0, 0, Math.PI / 2]);
    expect(x).toBeCloseTo(0);
    expect(y).toBeCloseTo(1);
    expect(z).toBeCloseTo(0);
    expect(rotated([1, 2, 3], [0, 0, 0])).toEqual([1, 2, 3]);
    const turn: Vec3 = [0.3, -1.1, 0.4];
    const there = new THREE.Vector3(1, 2, 3).applyAxisAngle(
      new THREE.Vector3(...turn).normalize(),
      Math.hypot(...turn),
    );
    rotated([1, 2, 3], turn).forEach((v, i) => expect(v).toBeCloseTo(there.getComponent(i)));
  });

  it('holds all of the stock, or not', () => {
    expect(reachesAll(reach(), stock.min, stock.max)).toBe(true);
    expect(reachesAll(reach({ half_mm: [49, 40, 40] }), stock.min, stock.max)).toBe(false);
    expect(reachesAll(reach({ center_mm: [20, 0, 0] }), stock.min, stock.max)).toBe(false);
    const across: Vec3 = [0, 0, Math.PI / 2];
    expect(reachesAll(reach({ turn_rad: across }), stock.min, stock.max)).toBe(false);
    const swapped: Vec3 = [40, 60, 40];
    const turned = reach({ turn_rad: across, half_mm: swapped });
    expect(reachesAll(turned, stock.min, stock.max)).toBe(true);
  });

  it('is outlined only where it leaves out a part of the stock', () => {
    const large = new ReachView(reach(), '#112233', stock);
    expect(large.leavesStockOut).toBe(false);
    expect(large.outline.visible).toBe(false);
    const small = new ReachView(
      reach({ half_mm: [10, 20, 30], turn_rad: [0, 0, 0.5] }),
      '#112233',
      stock,
    );
    expect(small.leavesStockOut).toBe(true);
    expect(small.outline.visible).toBe(true);
    small.outline.updateMatrixWorld();
    const corner = new THREE.Vector3(1, 1, 1).applyMatrix4(small.outline.matrixWorld);
    const wanted = rotated([10, 20, 30], [0, 0, 0.5]);
    expect(corner.x).toBeCloseTo(wanted[0]);
    expect(corner.y).toBeCloseTo(wanted[1]);
    expect(corner.z).toBeCloseTo(wanted[2] - 10);
    const material = small.outline.material as THREE.LineBasicMaterial;
    expect(material.color.getHexString()).toBe('112233');
  });
});
