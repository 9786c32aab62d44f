// SPDX-License-Identifier: Apache-2.0
// Force and torque as arrows, as in Fig. 16 of the paper: force in blue at the tool's tip, torque
// in red at the pivot, with a double head along the right-handed rotation axis. They are drawn
// without depth test, so that the block does not hide them.

import * as THREE from 'three';
import { WRENCH_COLORS } from '../model/arrow_scale';

const SHAFT = 0.011; // radii and lengths relative to the arrow length at full scale
const HEAD = 0.036;
const HEAD_LENGTH = 0.12;
const VISIBLE_FRACTION = 0.02;
const UP = new THREE.Vector3(0, 0, 1);

class Arrow {
  readonly group = new THREE.Group();
  private readonly shaft_: THREE.Mesh;
  private readonly heads_: THREE.Mesh[];
  private readonly direction_ = new THREE.Vector3();

  constructor(color: string, heads: number) {
    const material = new THREE.MeshBasicMaterial({
      color,
      depthTest: false,
      depthWrite: false,
      transparent: true,
      toneMapped: false,
    });
    this.shaft_ = new THREE.Mesh(
      new THREE.CylinderGeometry(SHAFT, SHAFT, 1, 16).translate(0, 0.5, 0).rotateX(Math.PI / 2),
      material,
    );
    const cone = new THREE.ConeGeometry(HEAD, HEAD_LENGTH, 24)
      .translate(0, -HEAD_LENGTH / 2, 0)
      .rotateX(Math.PI / 2);
    this.heads_ = Array.from({ length: heads }, () => new THREE.Mesh(cone, material));
    this.group.add(this.shaft_, ...this.heads_);
    for (const part of this.group.children) part.renderOrder = 10;
  }

  /**
   * @param part length relative to full scale, about 0 to 1.5; `fullMm` the length of a full-scale
   * arrow
   */
  set(
    origin: THREE.Vector3,
    vector: readonly [number, number, number],
    part: number,
    fullMm: number,
  ): void {
    this.group.visible = part > VISIBLE_FRACTION;
    if (!this.group.visible) return;
    this.direction_.set(...vector).normalize();
    this.group.position.copy(origin);
    this.group.quaternion.setFromUnitVectors(UP, this.direction_);
    this.group.scale.setScalar(fullMm);
    const headScale = Math.min(1, part / (HEAD_LENGTH * (this.heads_.length + 0.5)));
    this.shaft_.scale.set(1, 1, Math.max(1e-4, part - HEAD_LENGTH * headScale * 0.9));
    this.heads_.forEach((head, i) => {
      head.position.z = part - i * HEAD_LENGTH * headScale * 0.75;
      head.scale.setScalar(headScale);
    });
  }

  dispose(): void {
    this.shaft_.geometry.dispose();
    this.heads_[0]?.geometry.dispose();
    (this.shaft_.material as THREE.Material).dispose();
    this.group.removeFromParent();
  }
}

export class WrenchView {
  readonly group = new THREE.Group();
  private readonly force_ = new Arrow(WRENCH_COLORS.force, 1);
  private readonly torque_ = new Arrow(WRENCH_COLORS.torque, 2);
  private readonly origin_ = new THREE.Vector3();

  constructor() {
    this.group.add(this.force_.group, this.torque_.group);
  }

  /**
   * Places both arrows. An arrow of length `fullMm` represents `forceFullN` or `torqueFullNmm`;
   * lengths are limited to 1.5 times `fullMm`.
   */
  set(
    pose: {
      tip: readonly [number, number, number];
      axis: readonly [number, number, number];
      force: readonly [number, number, number];
      torque: readonly [number, number, number];
    },
    pivotMm: number,
    fullMm: number,
    forceFullN: number,
    torqueFullNmm: number,
  ): void {
    const part = (vector: readonly [number, number, number], full: number): number =>
      Math.min(1.5, Math.hypot(...vector) / full);
    this.origin_.set(...pose.tip);
    this.force_.set(this.origin_, pose.force, part(pose.force, forceFullN), fullMm);
    this.origin_.set(
      pose.tip[0] + pose.axis[0] * pivotMm,
      pose.tip[1] + pose.axis[1] * pivotMm,
      pose.tip[2] + pose.axis[2] * pivotMm,
    );
    this.torque_.set(this.origin_, pose.torque, part(pose.torque, torqueFullNmm), fullMm);
  }

  dispose(): void {
    this.force_.dispose();
    this.torque_.dispose();
    this.group.removeFromParent();
  }
}
