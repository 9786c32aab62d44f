// SPDX-License-Identifier: Apache-2.0

import { useSignalEffect } from '@preact/signals';
import type { Signal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useRef } from 'preact/hooks';

interface DialogProps {
  class: string;
  label: string;
  /** Becomes false when the user closes the dialog. */
  isOpen: Signal<boolean>;
  /** A press outside closes the dialog. */
  closesOutside?: boolean;
  /** The user or the page has closed the dialog. */
  closed?: () => void;
  children: ComponentChildren;
}

/** A modal dialog that is open while a signal says so. */
export function Dialog(props: DialogProps) {
  const { class: name, label, isOpen, closesOutside, closed, children } = props;
  const dialog = useRef<HTMLDialogElement>(null);
  useSignalEffect(() => {
    const { current } = dialog;
    if (!current || current.open === isOpen.value) return;
    if (isOpen.value) current.showModal();
    else current.close();
  });
  return (
    <dialog
      ref={dialog}
      class={name}
      aria-label={label}
      onClose={() => {
        isOpen.value = false;
        closed?.();
      }}
      onClick={({ target, currentTarget }) => {
        if (closesOutside && target === currentTarget) isOpen.value = false;
      }}
    >
      {children}
    </dialog>
  );
}
