// SPDX-License-Identifier: Apache-2.0
// Where the block stands in physical space: a similarity from block to physical space, which hands that hold the
// block change. Block: mm, Z up. Physical space: m, Y up, the floor at 0.

import * as THREE from 'three';
import type { Bounds } from '../../model/session';

/** A hand in physical space. */
export interface Grip {
  position: THREE.Vector3;
  quaternion: THREE.Quaternion;
}

const TABLE_M = 0.9; // height of the block's bottom at the start
const AHEAD_M = 0.55; // from the user to the block's center
const SIZE_M = 0.45; // of its longest side
/** Meters that a millimeter may take. */
const SCALE_MIN = 1e-5;
const SCALE_MAX = 1;
const UPRIGHT = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(1, 0, 0), -Math.PI / 2);
const HANDS_APART_M = 0.01; // closer hands tell no direction

export class Placement {
  /** Meters of physical space that a millimeter of the block takes. */
  scale = 1e-3;
  readonly quaternion = new THREE.Quaternion();
  /** Of the block's origin. */
  readonly position = new THREE.Vector3();
  private held_: (Grip | null)[] = [];
  private readonly matrix_ = new THREE.Matrix4();

  /** Puts a block upright in front of one who stands at the origin and looks along -Z. */
  stand({ min, max }: Bounds): void {
    const longest = Math.max(...max.map((value, i) => value - min[i]!));
    this.scale = Math.min(SCALE_MAX, Math.max(SCALE_MIN, SIZE_M / longest));
    this.quaternion.copy(UPRIGHT);
    const foot = new THREE.Vector3((min[0] + max[0]) / 2, (min[1] + max[1]) / 2, min[2]);
    foot.multiplyScalar(this.scale).applyQuaternion(this.quaternion);
    this.position.set(0, TABLE_M, -AHEAD_M).sub(foot);
    this.held_ = [];
  }

  /**
   * The hands that hold the block, each at its own index, null: it does not. One hand moves and turns
   * the block; two turn, move and scale it with the line between them. Called once a frame.
   */
  hold(grips: readonly (Grip | null)[]): void {
    const before = this.held_;
    this.held_ = grips.map(
      (grip) => grip && { position: grip.position.clone(), quaternion: grip.quaternion.clone() },
    );
    const steady: [Grip, Grip][] = [];
    grips.forEach((now, n) => {
      const was = before[n];
      if (was && now) steady.push([was, now]);
    });
    const holding = grips.filter((grip) => grip !== null).length;
    if (steady.length !== holding) return; // another hand has come: it counts from here
    if (steady.length === 1) this.moveBy_(...steady[0]!);
    if (steady.length === 2) this.stretchBy_(steady[0]!, steady[1]!);
  }

  /** From the block to physical space. */
  get toPhysical(): THREE.Matrix4 {
    const scale = new THREE.Vector3().setScalar(this.scale);
    return this.matrix_.compose(this.position, this.quaternion, scale);
  }

  private moveBy_(was: Grip, now: Grip): void {
    const turn = now.quaternion.clone().multiply(was.quaternion.clone().invert());
    this.turn_(turn, 1, was.position, now.position);
  }

  private stretchBy_([a0, a]: [Grip, Grip], [b0, b]: [Grip, Grip]): void {
    const was = b0.position.clone().sub(a0.position);
    const now = b.position.clone().sub(a.position);
    if (was.length() < HANDS_APART_M || now.length() < HANDS_APART_M) return;
    const wished = this.scale * (now.length() / was.length());
    const factor = Math.min(SCALE_MAX, Math.max(SCALE_MIN, wished)) / this.scale;
    const turn = new THREE.Quaternion().setFromUnitVectors(was.normalize(), now.normalize());
    const middle = (p: Grip, q: Grip): THREE.Vector3 => p.position.clone().lerp(q.position, 0.5);
    this.turn_(turn, factor, middle(a0, b0), middle(a, b));
  }

  /** Turns and scales about a point, which moves from one place to another. */
  private turn_(
    turn: THREE.Quaternion,
    factor: number,
    from: THREE.Vector3,
    to: THREE.Vector3,
  ): void {
    this.position.sub(from).multiplyScalar(factor).applyQuaternion(turn).add(to);
    this.quaternion.premultiply(turn).normalize();
    this.scale *= factor;
  }
}
