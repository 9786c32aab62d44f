// SPDX-License-Identifier: Apache-2.0
// Draws the scene of the page for the eyes of a headset. The scene stays in the block's millimeters;
// physical space, in meters, is an object in it, whose matrix says where the block stands.

import * as THREE from 'three';
import type { Viewer } from '../../view/viewer';

const NEAR_M = 0.02;
const FAR_M = 200;
const WALL = new THREE.Color('#dce3ea');
const SHADOWS_EVERY_MS = 250; // they cost as much as an eye
const BETWEEN_EYES = 0.35; // wider, as a tangent, is the view of both eyes than of one

export class Headset {
  /** In meters, Y up, with its origin on the floor. */
  readonly physical = new THREE.Group();
  private readonly camera_ = new THREE.PerspectiveCamera(70, 1, NEAR_M, FAR_M);
  /** Between the eyes, in the scene. */
  readonly eye = new THREE.Vector3();
  private shadowsMs_ = 0;

  constructor(private readonly viewer: Viewer) {
    this.physical.matrixAutoUpdate = false;
    this.physical.add(this.camera_);
  }

  /** In which poses are to be asked for; null: not yet. */
  get space(): XRReferenceSpace | null {
    return this.viewer.stage.renderer.xr.getReferenceSpace();
  }

  /** Resolves when the session draws: `frame` is called for each of its frames. */
  async begin(session: XRSession, frame: (nowMs: number, frame: XRFrame) => void): Promise<void> {
    const { renderer, scene } = this.viewer.stage;
    const { xr } = renderer;
    scene.add(this.physical);
    scene.background = WALL; // behind a headset is no page
    this.viewer.eyeElsewhere = this.eye;
    xr.enabled = true;
    xr.cameraAutoUpdate = false;
    xr.setReferenceSpaceType('local-floor');
    xr.setAnimationLoop(frame);
    await xr.setSession(session);
  }

  /** Draws the picture. Returns its cost. `toPhysical`: from the block to physical space. */
  draw(toPhysical: THREE.Matrix4, nowMs: number): { calls: number; triangles: number } {
    const { stage } = this.viewer;
    this.physical.matrix.copy(toPhysical).invert();
    this.physical.updateMatrixWorld(true);
    stage.renderer.xr.updateCamera(this.camera_);
    this.seeBoth_();
    this.eye.setFromMatrixPosition(this.camera_.matrixWorld);
    const withShadows = nowMs - this.shadowsMs_ > SHADOWS_EVERY_MS && this.viewer.takeShadows();
    if (withShadows) this.shadowsMs_ = nowMs;
    stage.render(this.camera_, withShadows, this.eye);
    const { calls, triangles } = stage.renderer.info.render;
    return { calls, triangles };
  }

  /** The page is drawn again. */
  end(): void {
    const { renderer, scene } = this.viewer.stage;
    renderer.xr.enabled = false;
    renderer.xr.setAnimationLoop(null);
    renderer.setAnimationLoop(null); // three has begun one for the time after the session
    scene.background = null;
    this.physical.removeFromParent();
    this.viewer.eyeElsewhere = null;
    this.viewer.touchAll();
  }

  /**
   * What neither eye sees is left out. three adds lengths of the scene and of physical space for this,
   * which are not of one unit here: this takes the left eye's view, and more at its sides.
   */
  private seeBoth_(): void {
    const both = this.viewer.stage.renderer.xr.getCamera();
    const [left, right] = both.cameras as (THREE.PerspectiveCamera | undefined)[];
    if (!left || !right) return;
    both.matrixWorld.copy(left.matrixWorld);
    both.matrixWorldInverse.copy(left.matrixWorldInverse);
    // The tangents of the four sides, of a projection that may be askew.
    const { elements: e } = left.projectionMatrix;
    const side = (sign: number, scale: number, shift: number): number => (sign + shift) / scale;
    const wide = (tangent: number): number =>
      NEAR_M * (tangent + Math.sign(tangent) * BETWEEN_EYES);
    both.projectionMatrix.makePerspective(
      wide(side(-1, e[0], e[8])),
      wide(side(1, e[0], e[8])),
      wide(side(1, e[5], e[9])),
      wide(side(-1, e[5], e[9])),
      NEAR_M,
      FAR_M,
    );
    both.projectionMatrixInverse.copy(both.projectionMatrix).invert();
  }
}
