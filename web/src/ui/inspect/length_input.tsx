// SPDX-License-Identifier: Apache-2.0

import { useSignal } from '@preact/signals';

interface LengthInputProps {
  class: string;
  label: string;
  value: number;
  min?: number;
  /** Called with the number once the user has finished it. */
  enter: (value: number) => void;
}

/** An input for a number, which shows the text that is being typed until it is entered. */
export function LengthInput({ class: name, label, value, min, enter }: LengthInputProps) {
  const typed = useSignal<string | null>(null);
  return (
    <input
      type="number"
      class={name}
      step="any"
      aria-label={label}
      min={min}
      value={typed.value ?? String(value)}
      onInput={({ currentTarget }) => (typed.value = currentTarget.value)}
      onChange={() => {
        const number = Number(typed.peek() ?? '');
        const isNumber = typed.peek() !== '' && Number.isFinite(number);
        typed.value = null;
        if (isNumber) enter(number);
      }}
      onBlur={() => (typed.value = null)}
    />
  );
}
