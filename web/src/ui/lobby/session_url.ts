// SPDX-License-Identifier: Apache-2.0
// Addresses of pages.

export function sessionUrl(id: string): string {
  return `?session=${encodeURIComponent(id)}`;
}
