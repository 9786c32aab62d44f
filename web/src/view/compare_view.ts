// SPDX-License-Identifier: Apache-2.0
// Two states of the block in one picture: right of an upright border the block is drawn as it was
// when the comparison began, left of it as it is displayed now. Shadows are those of the latter.

import * as THREE from 'three';
import type { Layer, Viewer } from './viewer';

export class CompareView implements Layer {
  private readonly meshes_: THREE.Mesh[];
  private readonly kept_ = new THREE.Group();
  private part_ = 0.5;

  constructor(private readonly viewer: Viewer) {
    this.meshes_ = viewer.tiles.copies();
    this.kept_.add(...this.meshes_);
    this.kept_.matrixAutoUpdate = false;
    viewer.layers.add(this);
    viewer.touch();
  }

  /** Where the border is: the share of the picture's width that is left of it. */
  set part(part: number) {
    this.part_ = part;
    this.viewer.touch();
  }

  draw(renderer: THREE.WebGLRenderer, camera: THREE.Camera): void {
    const { tiles, stage } = this.viewer;
    const { x: width, y: height } = renderer.getSize(new THREE.Vector2());
    const left = Math.round(this.part_ * width);
    if (left >= width) return;
    renderer.setScissorTest(true);
    renderer.setScissor(left, 0, width - left, height);
    stage.scene.remove(tiles.group);
    stage.scene.add(this.kept_);
    renderer.render(stage.scene, camera);
    stage.scene.remove(this.kept_);
    stage.scene.add(tiles.group);
    renderer.setScissorTest(false);
  }

  dispose(): void {
    this.viewer.layers.delete(this);
    for (const { geometry } of this.meshes_) geometry.dispose();
    this.viewer.touch();
  }
}
