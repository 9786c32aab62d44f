// SPDX-License-Identifier: Apache-2.0
// User settings in the browser's local storage. Where storage is disabled, they are not kept.

export function remember(key: string, value: string): void {
  try {
    localStorage.setItem(`kerf.${key}`, value);
  } catch {
    // Storage is disabled: the setting is not kept.
  }
}

export function recall(key: string): string | null {
  try {
    return localStorage.getItem(`kerf.${key}`);
  } catch {
    return null;
  }
}
