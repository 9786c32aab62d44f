// SPDX-License-Identifier: Apache-2.0
// A steady stroke: the tool is led on a string behind the pointer. It moves only while the string is
// taut, straight towards the pointer, so that a trembling hand draws a smooth line. The stroke ends
// where the tool is.

import type { Place } from './place';

export class Steady {
  /** Of the string, CSS pixels; 0: the tool is at the pointer. */
  lengthPx = 0;
  private at_: Place | null = null;
  private pointer_: Place | null = null;

  begin(place: Place): void {
    this.at_ = place;
    this.pointer_ = place;
  }

  end(): void {
    this.at_ = null;
    this.pointer_ = null;
  }

  /** Returns the places of the tool while the pointer goes through these. */
  follow(places: readonly Place[]): Place[] {
    return places.flatMap((place) => this.pull_(place) ?? []);
  }

  /** The string; null: there is none. */
  get stretch(): readonly [tool: Place, pointer: Place] | null {
    const { at_: at, pointer_: pointer } = this;
    return this.lengthPx > 0 && at && pointer ? [at, pointer] : null;
  }

  private pull_(place: Place): Place | null {
    const at = this.at_ ?? place;
    this.pointer_ = place;
    const px = Math.hypot(place.x - at.x, place.y - at.y);
    if (this.lengthPx > 0 && px <= this.lengthPx) return null;
    const part = this.lengthPx > 0 ? this.lengthPx / px : 0;
    const x = place.x + part * (at.x - place.x);
    const y = place.y + part * (at.y - place.y);
    this.at_ = { ...place, x, y };
    return this.at_;
  }
}
