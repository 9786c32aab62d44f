// SPDX-License-Identifier: Apache-2.0
// The tools of a program and the box of its stock, to be edited.

import { t } from '../../strings';
import type { Box, ToolChoice } from '../../model/new_block';
import type { Vec3 } from '../../wire/types';
import { h } from '../dom';
import { numberInput } from '../number_input';

const SHAPES: readonly [ToolChoice['shape'], string][] = [
  ['flat', t('flat end')],
  ['ball', t('ball end')],
  ['bull_nose', t('bull nose')],
];

function toolRow(tool: ToolChoice, changed: () => void): HTMLElement {
  const shape = h(
    'select',
    { 'aria-label': t('Shape of tool {0}', tool.id), class: 'select' },
    ...SHAPES.map(([value, name]) => h('option', { value }, name)),
  );
  const diameter = numberInput(t('Diameter of tool {0}, mm', tool.id), tool.diameterMm, (value) => {
    tool.diameterMm = value;
    changed();
  });
  const radius = numberInput(
    t('Corner radius of tool {0}, mm', tool.id),
    tool.cornerMm,
    (value) => {
      tool.cornerMm = value;
      changed();
    },
  );
  const corner = h('span', {}, t('corner '), radius, ' mm');
  const show = (): void => {
    corner.hidden = tool.shape !== 'bull_nose';
  };
  shape.value = tool.shape;
  show();
  shape.addEventListener('change', () => {
    tool.shape = shape.value as ToolChoice['shape'];
    show();
    changed();
  });
  return h(
    'li',
    {},
    h('b', {}, `T${tool.id}`),
    shape,
    h('span', {}, '⌀ ', diameter, ' mm'),
    corner,
  );
}

/** Inputs that write to `tools` as they are edited. */
export function toolTable(tools: ToolChoice[], changed: () => void): HTMLElement {
  const rows = tools.map((tool) => toolRow(tool, changed));
  return h(
    'div',
    {},
    h('span', { class: 'field-name' }, t('Tools')),
    h('ul', { class: 'tool-table' }, ...rows),
  );
}

/** Inputs for the corners of a box, which they write to. */
export function boxTable(box: Box, changed: () => void): HTMLElement {
  const corner = (label: string, at: Vec3): HTMLElement =>
    h(
      'div',
      { class: 'box-row' },
      h('span', { class: 'quiet' }, label),
      ...['X', 'Y', 'Z'].map((axis, n) =>
        h(
          'span',
          {},
          `${axis} `,
          numberInput(t('Stock {0} {1}, mm', label, axis), at[n]!, (value) => {
            at[n] = value;
            changed();
          }),
        ),
      ),
    );
  return h(
    'div',
    {},
    h('span', { class: 'field-name' }, t('Stock, mm')),
    corner(t('from'), box.min),
    corner(t('to'), box.max),
  );
}
