// SPDX-License-Identifier: Apache-2.0
// What pushing and turning the cap of a 3D mouse makes of the camera.

import type { Vec3 } from '../wire/types';

/** The object that follows the cap: the block, or the camera, as if one flew. */
export type CapSense = 'block' | 'camera';

/** Each part from -1 to 1. */
export interface CapPush {
  /** To the right, up, and towards the viewer. */
  move: Vec3;
  /** The cap's upper end, to the right and towards the viewer. */
  lean: readonly [right: number, towards: number];
  /** Clockwise, seen from above. */
  twist: number;
}

/** The part of the camera's rig that is used. */
export interface CameraStep {
  aroundRad: number;
  upRad: number;
  /** Of the view's height. */
  panRight: number;
  panUp: number;
  /** Of the distance. */
  zoom: number;
}

const TURN_RAD_PER_S = 1.5;
const HEIGHTS_PER_S = 1; // the same on the screen, however far away the block is
const ZOOM_PER_S = 1.5; // natural logarithm
const SLOWEST_S = 0.05; // a page that stood still does not jump

/** Returns how a push moves the camera within a time; null: it rests. Leaning aside does nothing. */
export function cameraStep(
  { move, lean, twist }: CapPush,
  sense: CapSense,
  timeS: number,
): CameraStep | null {
  const [right, up, towards] = move;
  const tilt = lean[1];
  if ([right, up, towards, tilt, twist].every((part) => part === 0)) return null;
  const time = (sense === 'block' ? 1 : -1) * Math.min(SLOWEST_S, Math.max(0, timeS));
  return {
    aroundRad: TURN_RAD_PER_S * time * twist,
    upRad: TURN_RAD_PER_S * time * tilt,
    panRight: -HEIGHTS_PER_S * time * right,
    panUp: -HEIGHTS_PER_S * time * up,
    zoom: Math.exp(-ZOOM_PER_S * time * towards),
  };
}
