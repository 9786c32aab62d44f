// SPDX-License-Identifier: Apache-2.0
// Draws force and torque along the path of a program as arrows of lines, which the block does not
// hide.

import * as THREE from 'three';
import { WRENCH_COLORS } from '../model/arrow_scale';
import { arrowLines, greatestOf } from '../model/wrench_path';
import type { WrenchPeak } from '../model/wrench_path';
import type { Viewer } from './viewer';

function linesOf(color: string): THREE.LineSegments {
  const material = new THREE.LineBasicMaterial({
    color,
    transparent: true,
    opacity: 0.9,
    depthTest: false,
    depthWrite: false,
    toneMapped: false,
  });
  const lines = new THREE.LineSegments(new THREE.BufferGeometry(), material);
  lines.frustumCulled = false;
  lines.visible = false;
  lines.renderOrder = 6; // over the path
  return lines;
}

export class WrenchPathView {
  private readonly force_ = linesOf(WRENCH_COLORS.force);
  private readonly torque_ = linesOf(WRENCH_COLORS.torque);

  constructor(private readonly viewer: Viewer) {
    viewer.stage.scene.add(this.force_, this.torque_);
  }

  /** `lengthMm`: of the longest arrow of force, and of torque. */
  show(peaks: readonly WrenchPeak[], lengthMm: number): void {
    const greatest = greatestOf(peaks);
    this.draw_(
      this.force_,
      arrowLines(peaks, ({ forceN }) => forceN, greatest.forceN, lengthMm),
    );
    this.draw_(
      this.torque_,
      arrowLines(peaks, ({ torqueNmm }) => torqueNmm, greatest.torqueNmm, lengthMm),
    );
    this.viewer.touch();
  }

  private draw_(lines: THREE.LineSegments, positions: Float32Array): void {
    lines.geometry.dispose();
    lines.geometry = new THREE.BufferGeometry();
    lines.geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
    lines.visible = positions.length > 0;
  }
}
