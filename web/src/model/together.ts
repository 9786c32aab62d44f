// SPDX-License-Identifier: Apache-2.0
// What viewers show each other: pins on the surface, and their cameras.

import type { Pin, ShownCamera } from '../wire/types';

export class Together {
  pins: readonly Pin[] = [];
  cameras: readonly ShownCamera[] = [];
  /** Grows with each change of the pins. */
  pinChanges = 0;

  /** Another connection or block begins: the server sends both again, if there are any. */
  clear(): void {
    if (this.pins.length > 0) this.setPins([]);
    this.cameras = [];
  }

  setPins(pins: readonly Pin[]): void {
    this.pins = pins;
    this.pinChanges += 1;
  }

  setCameras(cameras: readonly ShownCamera[]): void {
    this.cameras = cameras;
  }
}
