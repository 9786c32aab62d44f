// SPDX-License-Identifier: Apache-2.0

import { useSignal } from '@preact/signals';

/**
 * Returns the handlers of an area on which files may be dropped while `mayDrop` holds, and whether
 * files are dragged over it.
 */
export function useDrops(mayDrop: () => boolean, send: (files: FileList | null) => void) {
  const isOver = useSignal(false);
  const leave = (): void => void (isOver.value = false);
  return {
    isOver: isOver.value,
    handlers: {
      onDragOver: (event: DragEvent) => {
        if (!mayDrop() || !event.dataTransfer?.types.includes('Files')) return;
        event.preventDefault();
        isOver.value = true;
      },
      onDragLeave: leave,
      onDrop: (event: DragEvent) => {
        leave();
        if (!mayDrop()) return;
        event.preventDefault();
        send(event.dataTransfer?.files ?? null);
      },
    },
  };
}
