// SPDX-License-Identifier: Apache-2.0
// The cameras that other viewers show: a small pyramid from the eye along its sight, with the name.

import * as THREE from 'three';
import type { ShownCamera } from '../wire/types';
import { Label } from './labels';
import type { Layer, Viewer } from './viewer';

/** Of the distance from the eye to its target. */
const DEPTH = 0.08;
const HALF_WIDTH = 0.45;
const HALF_HEIGHT = 0.3;

/** Corners of the pyramid, with the tip at the eye, looking along -Z; pairs are lines. */
const CORNERS = [
  [-HALF_WIDTH, -HALF_HEIGHT],
  [HALF_WIDTH, -HALF_HEIGHT],
  [HALF_WIDTH, HALF_HEIGHT],
  [-HALF_WIDTH, HALF_HEIGHT],
] as const;
const LINES = Float32Array.from(
  CORNERS.flatMap(([x, y], n) => {
    const [nextX, nextY] = CORNERS[(n + 1) % 4]!;
    return [0, 0, 0, x, y, -1, x, y, -1, nextX, nextY, -1];
  }),
);

interface Mark {
  lines: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  label: Label;
}

export class CameraMarks implements Layer {
  private readonly marks_ = new Map<number, Mark>();
  private readonly geometry_ = new THREE.BufferGeometry();
  private shown_ = '[]';

  constructor(
    private readonly viewer: Viewer,
    private readonly overlay: HTMLElement,
  ) {
    this.geometry_.setAttribute('position', new THREE.BufferAttribute(LINES, 3));
    viewer.layers.add(this);
  }

  /** May be called often: the picture is drawn again only if they have changed. */
  show(cameras: readonly ShownCamera[]): void {
    const shown = JSON.stringify(cameras);
    if (shown === this.shown_) return;
    this.shown_ = shown;
    const listed = new Set(cameras.map(({ participant }) => participant));
    for (const [id, mark] of this.marks_) {
      if (!listed.has(id)) this.remove_(id, mark);
    }
    for (const camera of cameras) this.place_(camera);
    this.viewer.touch();
  }

  drawn(camera: THREE.Camera, width: number, height: number): void {
    for (const { lines, label } of this.marks_.values())
      label.place(lines.position, camera, width, height, 0);
  }

  private place_({ participant, name, color, eye_mm, target_mm }: ShownCamera): void {
    let mark = this.marks_.get(participant);
    if (!mark) {
      const material = new THREE.LineBasicMaterial({ color });
      mark = {
        lines: new THREE.LineSegments(this.geometry_, material),
        label: new Label(this.overlay),
      };
      this.marks_.set(participant, mark);
      this.viewer.stage.scene.add(mark.lines);
    }
    const { lines, label } = mark;
    label.set(name, color);
    lines.material.color.set(color);
    lines.position.set(...eye_mm);
    const target = new THREE.Vector3(...target_mm);
    const turned = new THREE.Matrix4().lookAt(lines.position, target, new THREE.Vector3(0, 0, 1));
    lines.quaternion.setFromRotationMatrix(turned);
    lines.scale.setScalar(DEPTH * lines.position.distanceTo(target));
  }

  private remove_(id: number, { lines, label }: Mark): void {
    this.viewer.stage.scene.remove(lines);
    lines.material.dispose();
    label.dispose();
    this.marks_.delete(id);
  }
}
