// SPDX-License-Identifier: Apache-2.0

import type { ReadonlySignal } from '@preact/signals';

/** Resolves with the next value of a signal, or with its value after `limitMs`. */
export function changeOf<T>(source: ReadonlySignal<T>, limitMs: number): Promise<T> {
  return new Promise((resolve) => {
    const first = source.peek();
    const stop = source.subscribe((value) => {
      if (value === first) return; // called at once with the value that is there
      end(value);
    });
    const limit = setTimeout(() => end(source.peek()), limitMs);
    const end = (value: T): void => {
      clearTimeout(limit);
      stop();
      resolve(value);
    };
  });
}
