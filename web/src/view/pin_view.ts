// SPDX-License-Identifier: Apache-2.0
// Pins over the block: a dot at the place, and the text above it, as HTML. Those on sides that face
// away are faint and have no text.

import * as THREE from 'three';
import { placeOf } from '../model/pin_place';
import type { Pin, Vec3 } from '../wire/types';
import type { Layer, Viewer } from './viewer';

/** Texts keep so far from the picture's sides. */
const MARGIN_PX = 8;

interface Mark {
  pin: Pin;
  at: Vec3;
  element: HTMLElement;
  label: HTMLElement;
  /** Of half of the label, once it has been measured. */
  halfPx: number;
}

function markOf(pin: Pin): Mark {
  const element = document.createElement('div');
  element.className = 'pin-mark';
  const label = document.createElement('div');
  label.className = 'pin-text';
  label.textContent = pin.text;
  element.append(label);
  element.hidden = true; // until the next frame has placed it
  return { pin, at: pin.at_mm, element, label, halfPx: 0 };
}

export class PinView implements Layer {
  private readonly root_ = document.createElement('div');
  private marks_: Mark[] = [];
  private surface_ = -1;

  constructor(
    private readonly viewer: Viewer,
    overlay: HTMLElement,
  ) {
    overlay.append(this.root_);
    viewer.layers.add(this);
  }

  show(pins: readonly Pin[]): void {
    this.marks_ = pins.map(markOf);
    this.root_.replaceChildren(...this.marks_.map(({ element }) => element));
    this.surface_ = -1;
    this.settle();
  }

  /** Puts the marks onto the surface if that has changed. */
  settle(): void {
    const { displayed } = this.viewer;
    if (this.surface_ === displayed.changes) return;
    this.surface_ = displayed.changes;
    const { pieces } = displayed;
    for (const mark of this.marks_) mark.at = placeOf(mark.pin, pieces);
    this.viewer.touch();
  }

  /** Where the mark of a pin is. */
  placeOf(pin: number): Vec3 | null {
    return this.marks_.find((mark) => mark.pin.pin === pin)?.at ?? null;
  }

  drawn(camera: THREE.Camera, width: number, height: number): void {
    const eye = new THREE.Vector3().setFromMatrixPosition(camera.matrixWorld);
    const forward = camera.getWorldDirection(new THREE.Vector3());
    const isParallel = camera instanceof THREE.OrthographicCamera;
    for (const mark of this.marks_) {
      const { pin, at, element, label } = mark;
      const place = new THREE.Vector3(...at);
      const seen = place.clone().project(camera);
      element.hidden = seen.z > 1;
      const sight = isParallel ? forward : place.sub(eye);
      element.classList.toggle('behind', sight.dot(new THREE.Vector3(...pin.normal)) > 0);
      const x = ((seen.x + 1) / 2) * width;
      const y = ((1 - seen.y) / 2) * height;
      element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      mark.halfPx ||= label.offsetWidth / 2;
      const least = mark.halfPx + MARGIN_PX;
      const shift = THREE.MathUtils.clamp(x, least, Math.max(least, width - least)) - x;
      label.style.transform = `translateX(calc(-50% + ${shift.toFixed(1)}px))`;
    }
  }
}
