// SPDX-License-Identifier: Apache-2.0
// Names above the tools, as HTML over the canvas: sharp at any pixel ratio.

import * as THREE from 'three';

const SCREEN_MARGIN_PX = 8;

export class Label {
  readonly element = document.createElement('div');
  private name_ = '';
  private color_ = '';
  private readonly projected_ = new THREE.Vector3();

  constructor(parent: HTMLElement) {
    this.element.className = 'tool-label';
    parent.append(this.element);
  }

  set(name: string, color: string): void {
    if (name === this.name_ && color === this.color_) return;
    this.name_ = name;
    this.color_ = color;
    this.element.textContent = name;
    this.element.style.setProperty('--who', color);
  }

  /** @param clearTop height covered by bars at the top, CSS pixels */
  place(
    world: THREE.Vector3,
    camera: THREE.Camera,
    width: number,
    height: number,
    clearTop: number,
  ): void {
    this.projected_.copy(world).project(camera);
    const { x, y, z } = this.projected_;
    const inFront = z > -1 && z < 1;
    this.element.hidden = !inFront;
    if (!inFront) return;
    const left = THREE.MathUtils.clamp(
      ((x + 1) / 2) * width,
      SCREEN_MARGIN_PX,
      width - SCREEN_MARGIN_PX,
    );
    const top = THREE.MathUtils.clamp(
      ((1 - y) / 2) * height,
      clearTop + 4 * SCREEN_MARGIN_PX,
      height - SCREEN_MARGIN_PX,
    );
    const position = `${left.toFixed(1)}px, ${top.toFixed(1)}px`;
    this.element.style.transform = `translate(-50%, -100%) translate(${position})`;
  }

  dispose(): void {
    this.element.remove();
  }
}
