// SPDX-License-Identifier: Apache-2.0

import { h } from './dom';

/** An input for a number; `set` is called with each number that is entered. */
export function numberInput(
  label: string,
  value: number,
  set: (value: number) => void,
): HTMLInputElement {
  const input = h('input', {
    type: 'number',
    step: 'any',
    class: 'number-input',
    'aria-label': label,
    value: String(value),
  });
  input.addEventListener('input', () => {
    if (Number.isFinite(input.valueAsNumber)) set(input.valueAsNumber);
  });
  return input;
}
