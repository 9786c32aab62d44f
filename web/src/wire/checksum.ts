// SPDX-License-Identifier: Apache-2.0
// The checksum of mesh frames: the mirror of server/wire/checksum.h.

/** Flag of a mesh frame whose longer header states a checksum. */
export const MESH_SUMMED = 4;
export const SUMMED_HEADER_BYTES = 40;

/** @param start the checksum of the preceding bytes */
export function checksum(bytes: Uint8Array, start = 0): number {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const step = (sum: number, word: number): number => {
    const mixed = Math.imul(sum ^ word, 0x9e3779b1);
    return mixed ^ (mixed >>> 15);
  };
  const whole = bytes.length & ~3;
  let sum = start;
  for (let at = 0; at < whole; at += 4) sum = step(sum, view.getUint32(at, true));
  if (whole === bytes.length) return sum >>> 0;
  let word = 0;
  for (let at = bytes.length - 1; at >= whole; --at) word = (word << 8) | bytes[at]!;
  return step(sum, word) >>> 0;
}
