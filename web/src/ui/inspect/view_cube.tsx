// SPDX-License-Identifier: Apache-2.0
// A cube that turns with the picture; its faces are buttons for the six views.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import type { Camera } from 'three';
import type { Preset } from '../../view/camera_rig';

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
  /** The matrix that turns the cube, as CSS has it; empty until the first picture. */
  readonly matrix = signal('');
  /** Toward the viewer, in coordinates of the block. */
  toward: readonly [number, number, number] = [0, 0, 1];

  /** Turns the cube as the camera shows the block. */
  turn(camera: Camera): void {
    const m = camera.matrixWorldInverse.elements;
    this.toward = [m[2], m[6], m[10]];
    // The y axis of a page points down.
    const turn = [m[0], -m[1], m[2], 0, -m[4], m[5], -m[6], 0, m[8], -m[9], m[10], 0, 0, 0, 0, 1];
    this.matrix.value = turn.map((value) => value.toFixed(4)).join(',');
  }
}

export function ViewCubeView({ cube, view }: { cube: ViewCube; view: (preset: Preset) => void }) {
  const { value: matrix } = cube.matrix;
  const [towardX, towardY, towardZ] = cube.toward;
  return (
    <div class="cube-box" role="group" aria-label={t('Views')}>
      <div class="cube" style={matrix === '' ? '' : `transform:matrix3d(${matrix})`}>
        {FACES.map(([preset, name, turn, [x, y, z]]) => {
          const facing = towardX * x + towardY * y + towardZ * z;
          return (
            <button
              key={preset}
              type="button"
              class="cube-face"
              style={{
                transform: `${turn} translateZ(var(--half))`,
                visibility: facing > 0.02 ? 'visible' : 'hidden',
              }}
              disabled={facing < LEAST_FACING}
              onClick={() => view(preset)}
            >
              {name}
            </button>
          );
        })}
      </div>
    </div>
  );
}
