// SPDX-License-Identifier: Apache-2.0
// Two states of the block in one picture: right of an upright border the block is drawn as it was
// when the comparison began, left of it as it is displayed now. Shadows are those of the latter.

import * as THREE from 'three';
import type { Layer, Viewer } from './viewer';

/** The tiles as they are displayed now, which stay. Their shapes are shared. */
function copiesOf(tiles: THREE.Group): THREE.InstancedMesh[] {
  const copies: THREE.InstancedMesh[] = [];
  for (const mesh of tiles.children) {
    if (!(mesh instanceof THREE.InstancedMesh)) continue;
    const kept = new THREE.InstancedMesh(
      mesh.geometry as THREE.BufferGeometry,
      mesh.material as THREE.Material,
      mesh.count,
    );
    kept.instanceMatrix.array.set(mesh.instanceMatrix.array.subarray(0, 16 * mesh.count));
    kept.matrixAutoUpdate = false;
    kept.receiveShadow = true;
    copies.push(kept);
  }
  return copies;
}

export class CompareView implements Layer {
  private readonly meshes_: THREE.InstancedMesh[];
  private readonly kept_ = new THREE.Group();
  private part_ = 0.5;

  constructor(private readonly viewer: Viewer) {
    this.meshes_ = copiesOf(viewer.tiles.group);
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
    const { tiles, layers } = this.viewer;
    layers.delete(this);
    const used = new Set(tiles.tiles().map(({ geometry }) => geometry));
    for (const mesh of this.meshes_) {
      if (!used.has(mesh.geometry)) mesh.geometry.dispose();
      mesh.dispose();
    }
    this.viewer.touch();
  }
}
