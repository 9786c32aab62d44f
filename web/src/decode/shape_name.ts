// SPDX-License-Identifier: Apache-2.0
// Names of shapes, by which equal tiles of different frames are drawn as instances of one mesh.

export type Numbers =
  | Int8Array<ArrayBuffer>
  | Uint8Array<ArrayBuffer>
  | Int16Array<ArrayBuffer>
  | Uint16Array<ArrayBuffer>
  | Uint32Array<ArrayBuffer>
  | Float32Array<ArrayBuffer>;

/**
 * Returns a text that is equal for equal arrays, and different for others with a probability of
 * 2^-64: two hashes (FNV-1a with different primes).
 */
export function shapeName(arrays: readonly Numbers[]): string {
  let one = 0x811c9dc5;
  let other = 0x9747b28c;
  const mix = (word: number): void => {
    one = Math.imul(one ^ word, 0x01000193);
    other = Math.imul(other ^ word, 0x5bd1e995);
    other ^= other >>> 15;
  };
  for (const array of arrays) {
    mix(array.length);
    for (const word of array) mix(word);
  }
  return `${one >>> 0} ${other >>> 0}`;
}
