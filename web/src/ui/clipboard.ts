// SPDX-License-Identifier: Apache-2.0

/** Copies a text; calls `done` when it is copied. Pages over plain HTTP have no clipboard. */
export function copyText(text: string, done: () => void): void {
  const clipboard = navigator.clipboard as Clipboard | undefined;
  void clipboard?.writeText(text).then(done);
}
