// SPDX-License-Identifier: Apache-2.0
// The sizes of a template's stock, to be edited.

import { t } from '../../strings';
import { h } from '../dom';
import { numberInput } from '../number_input';

/** The text before each size, and the name of its input. */
const BOX = ['X', 'Y', 'Z'].map((axis) => [axis, t('Size along {0}, mm', axis)] as const);
const CYLINDER = [
  ['⌀', t('Diameter, mm')],
  [t('height'), t('Height, mm')],
] as const;

/** Inputs that write to `sizes`: three of a box, two of a cylinder (model/stock_size.ts). */
export function sizeRow(sizes: number[], changed: () => void): HTMLElement {
  const names = sizes.length === BOX.length ? BOX : CYLINDER;
  const inputs = names.map(([sign, name], n) =>
    h(
      'span',
      {},
      `${sign} `,
      numberInput(name, sizes[n]!, (value) => {
        sizes[n] = value;
        changed();
      }),
    ),
  );
  return h(
    'div',
    {},
    h('span', { class: 'field-name' }, t('Size, mm')),
    h('div', { class: 'box-row' }, ...inputs),
  );
}
