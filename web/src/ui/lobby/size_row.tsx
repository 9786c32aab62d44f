// SPDX-License-Identifier: Apache-2.0

import type { Signal } from '@preact/signals';
import { t } from '../../strings';
import { NumberInput } from '../number_input';

/** The text before each size, and the name of its input. */
const BOX = ['X', 'Y', 'Z'].map((axis) => [axis, t('Size along {0}, mm', axis)] as const);
const CYLINDER = [
  ['⌀', t('Diameter, mm')],
  [t('height'), t('Height, mm')],
] as const;

/** The sizes of a template's stock: three of a box, two of a cylinder (model/stock_size.ts). */
export function SizeRow({ sizes }: { sizes: Signal<readonly number[]> }) {
  const names = sizes.value.length === BOX.length ? BOX : CYLINDER;
  return (
    <div>
      <span class="field-name">{t('Size, mm')}</span>
      <div class="box-row">
        {names.map(([sign, name], n) => (
          <span key={name}>
            {`${sign} `}
            <NumberInput
              label={name}
              value={sizes.value[n]!}
              set={(value) =>
                (sizes.value = sizes.peek().map((one, at) => (at === n ? value : one)))
              }
            />
          </span>
        ))}
      </div>
    </div>
  );
}
