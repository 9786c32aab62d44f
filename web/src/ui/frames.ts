// SPDX-License-Identifier: Apache-2.0
import type { Picture } from './picture';

/**
 * Greatest number of pictures per second: `?frames=` of the page's address, from 1 to 240, such as
 * the 20 of Zhu & Lee 2004 with an agent in mode paper. 0: as many as the browser shows.
 */
export function frameLimit(parameters: URLSearchParams): number {
  const limit = Number(parameters.get('frames') ?? '0');
  return limit >= 1 && limit <= 240 ? limit : 0;
}

/**
 * Calls back in each frame of the browser from now on, in at most `perSecond` of them if that is
 * not 0, but not while a picture is being drawn: changes of the page then make the browser compose
 * the page twice for one picture.
 */
export function eachFrame(picture: Picture, frame: (nowMs: number) => void, perSecond = 0): void {
  const everyMs = perSecond > 0 ? 1000 / perSecond : 0;
  // Frames of the browser do not come at exact times: one that comes a little early counts.
  const earlyMs = 2;
  let dueMs = 0;
  const next = (): number =>
    requestAnimationFrame((nowMs) => {
      if (nowMs + earlyMs < dueMs) return void next();
      // A page that was late does not catch up.
      dueMs = (nowMs - dueMs > everyMs ? nowMs : dueMs) + everyMs;
      frame(nowMs);
      void picture.shown().then(next);
    });
  next();
}
