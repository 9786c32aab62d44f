// SPDX-License-Identifier: Apache-2.0
// Where the server's picture of a block covers the block in the page's default view. Both look from
// the same direction (ISO_DIRECTION here, kFromFrontLeft in server/picture), each from as far away
// as its own picture needs.

import { firstLook } from './first_look';
import { boxCenter, FOV_DEG, ISO_DIRECTION, MARGIN, fitDistance, unit } from './fit';
import type { Viewport } from './fit';
import { stockBounds } from './session';
import type { Bounds } from './session';
import { cross, dot, minus, plus } from './vector';
import type { Vec3, Welcome } from '../wire/types';

/** Width over height of the server's pictures. */
const ASPECT = 4 / 3;
const TANGENT = Math.tan((FOV_DEG * Math.PI) / 360);

/** CSS pixels, of the page; the height is 3/4 of the width. */
export interface PosterPlace {
  left: number;
  top: number;
  width: number;
}

interface Box {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** Where a box is seen by an eye, in tangents of the angles to the right and downwards. */
function seen({ min, max }: Bounds, eye: Vec3): Box {
  const back = unit(ISO_DIRECTION);
  const side = unit(cross([0, 0, 1], back));
  const up = cross(back, side);
  const box = { left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity };
  for (let corner = 0; corner < 8; ++corner) {
    const at = (n: 0 | 1 | 2): number => ((corner >> n) & 1 ? max[n] : min[n]);
    const arm = minus([at(0), at(1), at(2)], eye);
    const depth = -dot(arm, back);
    const [x, y] = [dot(arm, side) / depth, -dot(arm, up) / depth];
    box.left = Math.min(box.left, x);
    box.right = Math.max(box.right, x);
    box.top = Math.min(box.top, y);
    box.bottom = Math.max(box.bottom, y);
  }
  return box;
}

/** Returns where the picture has to lie. */
export function posterPlace(welcome: Welcome, view: Viewport): PosterPlace {
  const bounds = stockBounds(welcome.stock);
  const back = unit(ISO_DIRECTION);
  const distance = MARGIN * fitDistance(bounds, back, TANGENT * ASPECT, TANGENT);
  const inPicture = seen(bounds, plus(boxCenter(bounds), back, distance));
  const inPage = seen(bounds, firstLook(welcome, view, 0).look.eye_mm);
  const pixels = view.height / 2 / TANGENT; // for a tangent of 1
  const { insets } = view;
  const middle = {
    x: (view.width + insets.left - insets.right) / 2,
    y: (view.height + insets.top - insets.bottom) / 2,
  };
  // The two distances differ in perspective: width and height count alike.
  const across = (inPage.right - inPage.left) / (inPicture.right - inPicture.left);
  const along = (inPage.bottom - inPage.top) / (inPicture.bottom - inPicture.top);
  const scale = pixels * Math.sqrt(across * along);
  const width = 2 * TANGENT * ASPECT * scale;
  const center = (a: number, b: number): number => (a + b) / 2;
  return {
    left:
      middle.x +
      pixels * center(inPage.left, inPage.right) -
      scale * center(inPicture.left, inPicture.right) -
      width / 2,
    top:
      middle.y +
      pixels * center(inPage.top, inPage.bottom) -
      scale * center(inPicture.top, inPicture.bottom) -
      width / ASPECT / 2,
    width,
  };
}
