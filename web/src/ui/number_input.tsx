// SPDX-License-Identifier: Apache-2.0

import { useSignal } from '@preact/signals';

interface NumberInputProps {
  label: string;
  value: number;
  /** Called with each number that is entered. */
  set: (value: number) => void;
  hidden?: boolean;
}

/** An input for a number. While it has the focus it shows the text that is being typed. */
export function NumberInput({ label, value, set, hidden = false }: NumberInputProps) {
  const typed = useSignal<string | null>(null);
  return (
    <input
      type="number"
      step="any"
      class="number-input"
      aria-label={label}
      value={typed.value ?? String(value)}
      onInput={({ currentTarget }) => {
        typed.value = currentTarget.value;
        if (Number.isFinite(currentTarget.valueAsNumber)) set(currentTarget.valueAsNumber);
      }}
      onBlur={() => (typed.value = null)}
      hidden={hidden}
    />
  );
}
