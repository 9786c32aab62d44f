// SPDX-License-Identifier: Apache-2.0
// One's own tool, or an image of it, as glass: cutter, shank and holder as the scene defines them.
// The group's origin is the tool's tip, its +Z the tool's axis.

import * as THREE from 'three';
import { toolProfile } from '../model/tool_profile';
import type { ToolInfo, Vec3 } from '../wire/types';
import { ghostMaterial } from './ghost_material';
import { lathe, setPose } from './tool_view';

const CUTTER = { facing: 0.07, outline: 0.95 };
const BODY = { facing: 0.03, outline: 0.45 };
const IMAGE = { facing: 0.03, outline: 0.6 };
const MEETS = '#e5331f'; // the block, with its side, shank or holder

export class GhostTool {
  readonly group = new THREE.Group();
  private readonly color_: THREE.Color;
  private readonly meets_ = new THREE.Color(MEETS);
  private readonly materials_: THREE.ShaderMaterial[] = [];

  /** `isImage`: where a mirror repeats the tool's strokes. */
  constructor(tool: ToolInfo, color: string, isImage: boolean) {
    this.color_ = new THREE.Color(color);
    const { pieces, body } = toolProfile(tool);
    const parts = [{ outline: pieces, look: isImage ? IMAGE : CUTTER }];
    if (!isImage && body.pieces.length > 0) parts.push({ outline: body.pieces, look: BODY });
    for (const { outline, look } of parts) {
      const material = ghostMaterial(color, look.facing, look.outline);
      const mesh = new THREE.Mesh(lathe(outline), material);
      mesh.renderOrder = 2;
      this.materials_.push(material);
      this.group.add(mesh);
    }
    this.group.visible = false;
  }

  setPose(tip: Readonly<Vec3>, axis: Readonly<Vec3>): void {
    setPose(this.group, tip, axis);
  }

  /** Whether its side, shank or holder meets the block: it is drawn in red then. */
  set meets(meets: boolean) {
    const color = meets ? this.meets_ : this.color_;
    for (const { uniforms } of this.materials_)
      (uniforms['color']!.value as THREE.Color).copy(color);
  }

  dispose(): void {
    this.group.traverse((object) => {
      if (object instanceof THREE.Mesh) (object.geometry as THREE.BufferGeometry).dispose();
    });
    for (const material of this.materials_) material.dispose();
    this.group.removeFromParent();
  }
}
