// SPDX-License-Identifier: Apache-2.0
// Requests that set and remove pins. All reject with a sentence that says why.

import type { Vec3 } from '../wire/types';
import { pathOf } from './address';
import { ask } from './strokes';

/** Bytes of UTF-8 that the server takes as the text of a pin. */
export const PIN_BYTES_MAX = 200;

/** @param author counts on a server that does not know the viewer's name by an invitation */
export async function setPin(
  session: string,
  text: string,
  at: Vec3,
  normal: Vec3,
  author: string,
): Promise<void> {
  const numbers = (place: Vec3): string => place.map((value) => value.toFixed(5)).join(',');
  const query = new URLSearchParams({
    text,
    at_mm: numbers(at),
    normal: numbers(normal),
    author,
  });
  await ask(pathOf(session, `pins?${query.toString().replaceAll('+', '%20')}`), 'POST');
}

export async function removePin(session: string, pin: number): Promise<void> {
  await ask(pathOf(session, `pins/${pin}`), 'DELETE');
}
