// SPDX-License-Identifier: Apache-2.0
// The box in which a participant's device can bring the tool, as a faint outline in the
// participant's color. It is shown only while a part of the stock is outside it.

import * as THREE from 'three';
import { reachesAll } from '../model/reach';
import type { Reach } from '../wire/reach';
import type { Vec3 } from '../wire/types';

const OPACITY = 0.35;

export class ReachView {
  readonly outline: THREE.LineSegments;
  /** A part of the stock is out of the device's reach. */
  readonly leavesStockOut: boolean;

  constructor(
    readonly reach: Reach,
    color: string,
    stock: { min: Vec3; max: Vec3 },
  ) {
    const edges = new THREE.EdgesGeometry(new THREE.BoxGeometry(2, 2, 2));
    const material = new THREE.LineBasicMaterial({
      color,
      transparent: true,
      opacity: OPACITY,
      depthWrite: false,
    });
    this.outline = new THREE.LineSegments(edges, material);
    this.outline.position.set(...reach.center_mm);
    this.outline.scale.set(...reach.half_mm);
    const turn = new THREE.Vector3(...reach.turn_rad);
    const angle = turn.length();
    if (angle > 0) this.outline.quaternion.setFromAxisAngle(turn.normalize(), angle);
    this.leavesStockOut = !reachesAll(reach, stock.min, stock.max);
    this.outline.visible = this.leavesStockOut;
  }

  dispose(): void {
    this.outline.geometry.dispose();
    (this.outline.material as THREE.Material).dispose();
    this.outline.removeFromParent();
  }
}
