// SPDX-License-Identifier: Apache-2.0
// Shows the stock before the first cut: its surface, translucent, and its edges.

import * as THREE from 'three';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import type { Viewer } from '../viewer';

const COLOR = '#2f6fd6';
/** An edge is drawn where faces meet at more than this. */
const EDGE_DEG = 25;

export class GhostView {
  private readonly group_ = new THREE.Group();

  /** @param stl the stock as a binary STL file */
  constructor(
    private readonly viewer: Viewer,
    stl: ArrayBuffer,
  ) {
    const surface = new STLLoader().parse(stl);
    const faces = new THREE.MeshBasicMaterial({
      color: COLOR,
      transparent: true,
      opacity: 0.1,
      depthWrite: false,
    });
    const edges = new THREE.LineBasicMaterial({ color: COLOR, transparent: true, opacity: 0.7 });
    this.group_.add(
      new THREE.Mesh(surface, faces),
      new THREE.LineSegments(new THREE.EdgesGeometry(surface, EDGE_DEG), edges),
    );
    viewer.stage.scene.add(this.group_);
    viewer.touch();
  }

  dispose(): void {
    this.viewer.stage.scene.remove(this.group_);
    for (const object of this.group_.children as (THREE.Mesh | THREE.LineSegments)[]) {
      object.geometry.dispose();
      (object.material as THREE.Material).dispose();
    }
    this.viewer.touch();
  }
}
