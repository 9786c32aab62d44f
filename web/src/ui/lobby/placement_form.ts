// SPDX-License-Identifier: Apache-2.0
// Unit, scale, turns and place of a model, to be edited, and the size that it has so.

import { t } from '../../strings';
import type { UploadedMesh } from '../../link/lobby_requests';
import { isRight, placedBox, UNITS_MM } from '../../model/placement';
import type { Placement } from '../../model/placement';
import type { Vec3 } from '../../wire/types';
import { h, setText } from '../dom';
import { numberInput } from '../number_input';

function sizeText({ box }: UploadedMesh, placement: Placement): string {
  const { min, max } = placedBox(box, placement);
  const side = (n: number): string => (max[n]! - min[n]!).toFixed(1);
  const place = (n: number): string => min[n]!.toFixed(1);
  const size = t(
    '{0} × {1} × {2} mm, from X {3} Y {4} Z {5}',
    side(0),
    side(1),
    side(2),
    place(0),
    place(1),
    place(2),
  );
  return isRight(placement) ? size : t('Up to {0}', size);
}

function axesRow(
  name: string,
  label: (axis: string) => string,
  values: Vec3,
  changed: () => void,
): HTMLElement {
  const inputs = ['X', 'Y', 'Z'].map((axis, n) =>
    h(
      'span',
      {},
      `${axis} `,
      numberInput(label(axis), values[n]!, (value) => {
        values[n] = value;
        changed();
      }),
    ),
  );
  return h('div', { class: 'box-row' }, h('span', { class: 'quiet wide' }, name), ...inputs);
}

function unitField(placement: Placement, changed: () => void): HTMLElement {
  const options = Object.keys(UNITS_MM).map((unit) => h('option', { value: unit }, unit));
  const unit = h('select', { class: 'text-input' }, ...options);
  unit.addEventListener('change', () => {
    placement.unit = unit.value;
    changed();
  });
  const name = h('span', { class: 'field-name' }, t('Unit of the model'));
  return h('label', { class: 'field' }, name, unit);
}

/** Inputs that write to `placement`; `asksUnit`: the file states no unit. */
export function placementForm(
  mesh: UploadedMesh,
  placement: Placement,
  asksUnit: boolean,
  changed: () => void,
): HTMLElement {
  const size = h('p', { role: 'status' }, sizeText(mesh, placement));
  const question = h(
    'p',
    { role: 'alert', class: 'bad' },
    t('Is this the right size? Choose the unit.'),
  );
  question.hidden = !mesh.isUnlikely;
  const update = (): void => {
    setText(size, sizeText(mesh, placement));
    question.hidden = !mesh.isUnlikely || placement.unit !== 'mm' || placement.scale !== 1;
    changed();
  };
  const scale = numberInput(t('Scale'), placement.scale, (value) => {
    placement.scale = value;
    update();
  });
  const more = h(
    'details',
    {},
    h('summary', {}, t('Rotate, scale, move')),
    axesRow(
      t('Rotate, degrees'),
      (axis) => t('Rotate about {0}, degrees', axis),
      placement.rotateDeg,
      update,
    ),
    h('div', { class: 'box-row' }, h('span', { class: 'quiet wide' }, t('Scale')), scale),
    axesRow(t('Move, mm'), (axis) => t('Move along {0}, mm', axis), placement.translateMm, update),
  );
  return h(
    'div',
    { class: 'draft-mesh' },
    size,
    ...(asksUnit ? [question, unitField(placement, update)] : []),
    more,
  );
}
