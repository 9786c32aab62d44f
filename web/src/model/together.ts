// SPDX-License-Identifier: Apache-2.0
// The pins on the surface and the cameras that viewers show each other, as values of signals.

import { signal } from '@preact/signals';
import type { Pin, ShownCamera } from '../wire/types';

export class Together {
  private readonly pins_ = signal<readonly Pin[]>([]);
  private readonly cameras_ = signal<readonly ShownCamera[]>([]);

  get pins(): readonly Pin[] {
    return this.pins_.value;
  }

  get cameras(): readonly ShownCamera[] {
    return this.cameras_.value;
  }

  /** Another connection or block begins: the server sends both again, if there are any. */
  clear(): void {
    if (this.pins_.peek().length > 0) this.setPins([]);
    this.cameras_.value = [];
  }

  setPins(pins: readonly Pin[]): void {
    this.pins_.value = pins;
  }

  setCameras(cameras: readonly ShownCamera[]): void {
    this.cameras_.value = cameras;
  }
}
