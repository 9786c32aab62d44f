// SPDX-License-Identifier: Apache-2.0
// The handle of the section plane in the picture: dragged along the plane's normal, or moved by the
// arrow keys.

import { t } from '../../strings';
import { Vector3 } from 'three';
import type { Camera } from 'three';
import type { Plane } from '../../model/section';
import type { Vec3 } from '../../wire/types';
import { h } from '../dom';

/** Of the plane's normal: seen more steeply from in front, no drag could say how far. */
const LEAST_SLOPE = 0.08;

export class Handle {
  readonly element = h('button', {
    type: 'button',
    class: 'section-handle',
    role: 'slider',
    'aria-label': t('Section plane'),
    'aria-orientation': 'vertical',
    title: t('Drag the section plane'),
    hidden: '',
  });
  private plane_: Plane | null = null;
  private anchor_: Vec3 = [0, 0, 0];
  /** Where a millimeter along the normal is in the picture, CSS pixels. */
  private perMm_ = [0, -1] as [number, number];
  private drag_: { x: number; y: number; offset: number } | null = null;

  /** @param moved is called with the plane's new offset; `stepMm`: of an arrow key */
  constructor(
    private readonly moved: (offset: number) => void,
    stepMm: () => number,
  ) {
    const { element } = this;
    element.addEventListener('pointerdown', (event) => {
      if (!this.plane_) return;
      element.setPointerCapture(event.pointerId);
      this.drag_ = { x: event.clientX, y: event.clientY, offset: this.plane_.offset };
    });
    element.addEventListener('pointermove', (event) => this.dragTo_(event));
    for (const end of ['pointerup', 'pointercancel'] as const)
      element.addEventListener(end, () => (this.drag_ = null));
    element.addEventListener('keydown', (event) => {
      const sign = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[event.key];
      if (sign === undefined || !this.plane_) return;
      event.preventDefault();
      event.stopPropagation();
      this.moved(this.plane_.offset + sign * stepMm() * (event.shiftKey ? 10 : 1));
    });
  }

  /** @param anchor a point of the plane; `place`: the text that is read out */
  show(plane: Plane | null, anchor: Vec3, place: string): void {
    this.plane_ = plane;
    this.anchor_ = anchor;
    if (!plane) {
      this.element.hidden = true;
      return;
    }
    this.element.setAttribute('aria-valuenow', plane.offset.toFixed(3));
    this.element.setAttribute('aria-valuetext', place);
  }

  /** Puts it where the plane is in a picture of this size, a pixel of which is `pixelMm` there. */
  place(camera: Camera, width: number, height: number, pixelMm: number): void {
    if (!this.plane_) return;
    const seen = (at: Vector3): [number, number] => {
      const { x, y } = at.project(camera);
      return [((x + 1) / 2) * width, ((1 - y) / 2) * height];
    };
    const [x, y] = seen(new Vector3(...this.anchor_));
    const next = new Vector3(...this.plane_.normal).add(new Vector3(...this.anchor_));
    const [nextX, nextY] = seen(next);
    this.perMm_ = [nextX - x, nextY - y];
    this.element.hidden = Math.hypot(...this.perMm_) * pixelMm < LEAST_SLOPE;
    const turn = Math.atan2(nextY - y, nextX - x);
    this.element.style.transform =
      `translate(-50%, -50%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) ` +
      `rotate(${turn.toFixed(3)}rad)`;
  }

  private dragTo_(event: PointerEvent): void {
    if (!this.drag_) return;
    const [x, y] = this.perMm_;
    const along = (event.clientX - this.drag_.x) * x + (event.clientY - this.drag_.y) * y;
    this.moved(this.drag_.offset + along / (x * x + y * y));
  }
}
