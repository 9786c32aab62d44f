// SPDX-License-Identifier: Apache-2.0
// A cube that turns with the picture; its faces are buttons for the six views.

import { t } from '../../strings';
import type { Camera } from 'three';
import type { Preset } from '../../view/camera_rig';
import { h } from '../dom';

/** How the faces lie on the cube: outwards, and upright in their view. */
const FACES: readonly [Preset, string, string, readonly [number, number, number]][] = [
  ['top', t('Top'), '', [0, 0, 1]],
  ['bottom', t('Bottom'), 'rotateX(180deg)', [0, 0, -1]],
  ['front', t('Front'), 'rotateX(-90deg)', [0, -1, 0]],
  ['back', t('Back'), 'rotateX(90deg) rotateZ(180deg)', [0, 1, 0]],
  ['right', t('Right'), 'rotateY(90deg) rotateZ(-90deg)', [1, 0, 0]],
  ['left', t('Left'), 'rotateY(-90deg) rotateZ(90deg)', [-1, 0, 0]],
];

/** Cosine of the angle from which a face is wide enough to be pressed. */
const LEAST_FACING = 0.45;

export class ViewCube {
  private readonly faces_: HTMLButtonElement[];
  private readonly cube_: HTMLElement;
  readonly element: HTMLElement;
  private shown_ = '';

  constructor(view: (preset: Preset) => void) {
    this.faces_ = FACES.map(([preset, name, turn]) => {
      const button = h('button', { type: 'button', class: 'cube-face' }, name);
      button.style.transform = `${turn} translateZ(var(--half))`;
      button.addEventListener('click', () => view(preset));
      return button;
    });
    this.cube_ = h('div', { class: 'cube' }, ...this.faces_);
    this.element = h(
      'div',
      { class: 'cube-box', role: 'group', 'aria-label': t('Views') },
      this.cube_,
    );
  }

  /** Turns the cube as the camera shows the block. */
  turn(camera: Camera): void {
    const m = camera.matrixWorldInverse.elements;
    // The y axis of a page points down.
    const turn = [m[0], -m[1], m[2], 0, -m[4], m[5], -m[6], 0, m[8], -m[9], m[10], 0, 0, 0, 0, 1];
    const text = turn.map((value) => value.toFixed(4)).join(',');
    if (text === this.shown_) return;
    this.shown_ = text;
    this.cube_.style.transform = `matrix3d(${text})`;
    FACES.forEach(([, , , [x, y, z]], n) => {
      const facing = m[2] * x + m[6] * y + m[10] * z;
      this.faces_[n]!.style.visibility = facing > 0.02 ? '' : 'hidden';
      this.faces_[n]!.disabled = facing < LEAST_FACING;
    });
  }
}
