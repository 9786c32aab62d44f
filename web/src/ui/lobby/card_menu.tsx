// SPDX-License-Identifier: Apache-2.0
// The actions of one session in the list: rename, duplicate, close.

import { useSignal } from '@preact/signals';
import { useRef } from 'preact/hooks';
import { t } from '../../strings';

export interface CardAction {
  label: string;
  act: () => void;
}

interface CardMenuProps {
  /** Name of the session. */
  name: string;
  /** Those that the viewer may perform; none: no menu. */
  actions: readonly CardAction[];
}

/** A button that shows the actions; Escape, and the focus elsewhere, hide them. */
export function CardMenu({ name, actions }: CardMenuProps) {
  const isOpen = useSignal(false);
  const opener = useRef<HTMLButtonElement>(null);
  if (actions.length === 0) return null;
  return (
    <div
      class="card-menu"
      onKeyDown={(event) => {
        if (event.key !== 'Escape' || !isOpen.value) return;
        isOpen.value = false;
        opener.current?.focus();
      }}
      onFocusOut={({ relatedTarget, currentTarget }) => {
        if (!currentTarget.contains(relatedTarget as Node | null)) isOpen.value = false;
      }}
    >
      <button
        ref={opener}
        type="button"
        class="card-more"
        aria-label={t('More for {0}', name)}
        aria-expanded={isOpen.value}
        onClick={() => (isOpen.value = !isOpen.value)}
      >
        {t('More')}
      </button>
      <ul class="card-actions" hidden={!isOpen.value}>
        {actions.map(({ label, act }) => (
          <li key={label}>
            <button
              type="button"
              onClick={() => {
                isOpen.value = false;
                opener.current?.focus(); // a dialog gives the focus back to it
                act();
              }}
            >
              {label}
            </button>
          </li>
        ))}
      </ul>
    </div>
  );
}
