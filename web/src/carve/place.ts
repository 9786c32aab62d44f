// SPDX-License-Identifier: Apache-2.0

/** A place of the picture, CSS pixels from its corner. */
export interface Place {
  x: number;
  y: number;
  /** Of a pen, 0 to 1; null: the device does not tell. */
  pressure: number | null;
  /**
   * Where the end of a pen leans: the parts of its unit axis to the right and down in the picture;
   * null: it stands upright, or the device does not tell.
   */
  tilt: readonly [right: number, down: number] | null;
}
