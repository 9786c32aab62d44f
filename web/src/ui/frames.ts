// SPDX-License-Identifier: Apache-2.0
import type { Picture } from './picture';

/**
 * Calls back in each frame of the browser from now on, but not while a picture is being drawn: what
 * the page changes then would have the browser put the page together twice for one picture.
 */
export function eachFrame(picture: Picture, frame: (nowMs: number) => void): void {
  const next = (): number =>
    requestAnimationFrame((nowMs) => {
      frame(nowMs);
      void picture.shown().then(next);
    });
  next();
}
