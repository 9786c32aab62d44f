// SPDX-License-Identifier: Apache-2.0
// Draws measures over the block: lines, the point under the pointer, and the figures as HTML.

import * as THREE from 'three';
import type { Snapped } from '../../model/snap';
import type { Vec3 } from '../../wire/types';
import type { Layer, Viewer } from '../viewer';

/** A line from point to point, and the text at it. */
export interface Figure {
  line: readonly Vec3[];
  place: Vec3;
  text: string;
}

const COLOR = '#6a1fb5';
const POINTER_COLORS: Record<Snapped['kind'], string> = {
  corner: '#d8262c',
  edge: '#1f66e5',
  face: COLOR,
};

function segmentsOf(lines: readonly (readonly Vec3[])[]): Float32Array {
  const places: number[] = [];
  for (const line of lines)
    for (let n = 1; n < line.length; n += 1) places.push(...line[n - 1]!, ...line[n]!);
  return Float32Array.from(places);
}

function replacePositions(object: THREE.LineSegments | THREE.Points, places: Float32Array): void {
  object.geometry.dispose();
  object.geometry = new THREE.BufferGeometry();
  object.geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
}

export class MeasureView implements Layer {
  private readonly lines_ = new THREE.LineSegments(
    new THREE.BufferGeometry(),
    new THREE.LineBasicMaterial({ color: COLOR, depthTest: false, transparent: true }),
  );
  private readonly points_ = new THREE.Points(
    new THREE.BufferGeometry(),
    new THREE.PointsMaterial({
      color: COLOR,
      size: 7,
      sizeAttenuation: false,
      depthTest: false,
      transparent: true,
    }),
  );
  private readonly pointer_ = document.createElement('div');
  private pointerAt_: Vec3 | null = null;
  private readonly labels_ = document.createElement('div');
  private figures_: readonly Figure[] = [];

  constructor(
    private readonly viewer: Viewer,
    overlay: HTMLElement,
  ) {
    this.pointer_.className = 'measure-pointer';
    this.pointer_.hidden = true;
    overlay.append(this.labels_, this.pointer_);
    for (const object of [this.lines_, this.points_]) {
      object.frustumCulled = false;
      object.renderOrder = 10;
    }
    viewer.stage.scene.add(this.lines_, this.points_);
    viewer.layers.add(this);
  }

  /** @param pressed the points that were pressed so far */
  show(figures: readonly Figure[], pressed: readonly Vec3[]): void {
    this.figures_ = figures;
    replacePositions(this.lines_, segmentsOf(figures.map(({ line }) => line)));
    const ends = figures.flatMap(({ line }) => (line.length <= 4 ? line : []));
    replacePositions(this.points_, Float32Array.from([...ends, ...pressed].flat()));
    this.labels_.replaceChildren(
      ...figures.map(({ text }) => {
        const label = document.createElement('div');
        label.className = 'measure-label';
        label.textContent = text;
        return label;
      }),
    );
    this.viewer.touch();
  }

  /** Shows the point that a press would take; null hides it. */
  point(snapped: Snapped | null): void {
    this.pointerAt_ = snapped?.point ?? null;
    if (snapped) {
      this.pointer_.style.borderColor = POINTER_COLORS[snapped.kind];
      this.pointer_.dataset['kind'] = snapped.kind;
    }
    this.viewer.touch();
  }

  drawn(camera: THREE.Camera, width: number, height: number): void {
    const place = (element: HTMLElement, at: Vec3): void => {
      const seen = new THREE.Vector3(...at).project(camera);
      element.hidden = seen.z > 1;
      const x = ((seen.x + 1) / 2) * width;
      const y = ((1 - seen.y) / 2) * height;
      element.style.transform = `translate(-50%, -50%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    };
    this.figures_.forEach(({ place: at }, n) => place(this.labels_.children[n] as HTMLElement, at));
    this.pointer_.hidden = true;
    if (this.pointerAt_) place(this.pointer_, this.pointerAt_);
  }

  dispose(): void {
    this.viewer.layers.delete(this);
    this.viewer.stage.scene.remove(this.lines_, this.points_);
    for (const { geometry, material } of [this.lines_, this.points_]) {
      geometry.dispose();
      material.dispose();
    }
    this.labels_.remove();
    this.pointer_.remove();
    this.viewer.touch();
  }
}
