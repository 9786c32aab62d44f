// SPDX-License-Identifier: Apache-2.0
// Small things that the browser keeps for the user. Browsers that forbid it just forget.

export function remember(key: string, value: string): void {
  try {
    localStorage.setItem(`kerf.${key}`, value);
  } catch { /* storage is off: nothing is lost but comfort */ }
}

export function recall(key: string): string | null {
  try {
    return localStorage.getItem(`kerf.${key}`);
  } catch {
    return null;
  }
}
