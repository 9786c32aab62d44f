// SPDX-License-Identifier: Apache-2.0
// A straight line in the picture, from where it begins, in the direction in which the pointer leaves.

import type { Place } from './place';

const DIRECTION_PX = 12; // a shorter path tells no direction

export class Straight {
  private direction_: readonly [number, number] | null = null;

  constructor(private readonly from: Place) {}

  /** The place on the line next to a place; null: the pointer has not left yet. */
  along(place: Place): Place | null {
    const { from } = this;
    const [dx, dy] = [place.x - from.x, place.y - from.y];
    const length = Math.hypot(dx, dy);
    if (!this.direction_ && length < DIRECTION_PX) return null;
    this.direction_ ??= [dx / length, dy / length];
    const [ux, uy] = this.direction_;
    const reach = dx * ux + dy * uy;
    return { ...place, x: from.x + reach * ux, y: from.y + reach * uy };
  }
}
