// SPDX-License-Identifier: Apache-2.0
// Names of participants and programs, which the server limits in bytes (server/wire/limits.h).

export const NAME_BYTES_MAX = 64;

/** Cuts `name` so that name + extension has at most NAME_BYTES_MAX bytes of UTF-8; appends that. */
export function nameThatFits(name: string, extension = ''): string {
  const bytes = (text: string): number => new TextEncoder().encode(text).length;
  let left = NAME_BYTES_MAX - bytes(extension);
  let kept = '';
  for (const character of name) {
    left -= bytes(character);
    if (left < 0) break;
    kept += character;
  }
  return kept + extension;
}
