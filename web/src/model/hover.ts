// SPDX-License-Identifier: Apache-2.0
// Decides when the server is asked about the place under the pointer: when it has rested there, and
// again when the surface has changed meanwhile, with one request at a time.

/** CSS pixels from the picture's upper left corner. */
export interface PicturePlace {
  x: number;
  y: number;
}

const REST_MS = 150;
const AGAIN_MS = 1000; // between requests about one place
const TREMBLE_PX = 3;

export class Hover {
  private place_: PicturePlace | null = null;
  private since_ = 0;
  private asked_: string | null = null; // the surface that was asked about here
  private askedMs_ = 0;
  private isAsking_ = false;

  /** The place that is asked about; null: none. */
  get place(): PicturePlace | null {
    return this.place_;
  }

  /** The pointer is here. Returns whether that is another place than before. */
  move(place: PicturePlace, nowMs: number): boolean {
    const { place_: old } = this;
    if (old && Math.hypot(place.x - old.x, place.y - old.y) < TREMBLE_PX) return false;
    this.begin_(place, nowMs);
    return true;
  }

  /** A press asks about a place at once. */
  press(place: PicturePlace): void {
    this.begin_(place, -Infinity);
  }

  /** The picture has moved under the pointer. */
  restart(nowMs: number): void {
    if (this.place_) this.begin_({ ...this.place_ }, nowMs);
  }

  leave(): void {
    this.place_ = null;
  }

  /**
   * Returns the place that has to be asked about now, null if none has to be; answered() follows.
   * @param surface differs when the surface does
   */
  due(surface: string, nowMs: number): PicturePlace | null {
    const { place_: place, asked_: asked } = this;
    if (!place || this.isAsking_ || surface === asked) return null;
    if (nowMs - this.since_ < REST_MS) return null;
    if (asked !== null && nowMs - this.askedMs_ < AGAIN_MS) return null;
    this.asked_ = surface;
    this.askedMs_ = nowMs;
    this.isAsking_ = true;
    return place;
  }

  /** Returns whether the answer is still about the place under the pointer. */
  answered(place: PicturePlace): boolean {
    this.isAsking_ = false;
    return place === this.place_;
  }

  private begin_(place: PicturePlace, sinceMs: number): void {
    this.place_ = place;
    this.since_ = sinceMs;
    this.asked_ = null;
  }
}
