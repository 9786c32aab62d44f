// SPDX-License-Identifier: Apache-2.0
// Where the page looks from before anyone has moved the camera. Computed from the welcome alone, so
// that the server gets it before the GPU is ready and sends no tile twice.

import type { Look, Welcome } from '../wire/types';
import { boxCenter, ISO_DIRECTION, unit, viewDistance } from './fit';
import type { Viewport } from './fit';
import { stockBounds } from './session';
import type { Bounds } from './session';
import { toolProfile } from './tool_profile';

/** A look, and the camera's distance to its target. */
export interface PlacedLook {
  look: Look;
  distanceMm: number;
}

/**
 * Returns the box that a full view shows: the block, extended upward by part of the longest tool.
 */
export function viewBounds({ stock, tools }: Welcome): Bounds {
  const { min, max } = stockBounds(stock);
  const longest = Math.max(0, ...tools.map((tool) => toolProfile(tool).lengthMm));
  const diagonal = Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
  return { min, max: [max[0], max[1], max[2] + Math.min(0.6 * longest, 0.16 * diagonal)] };
}

/** Returns the default view of a session. */
export function firstLook(welcome: Welcome, view: Viewport, error_rad: number): PlacedLook {
  const bounds = viewBounds(welcome);
  const arm = unit(ISO_DIRECTION);
  const distanceMm = viewDistance(bounds, arm, view);
  const center = boxCenter(bounds);
  return {
    look: {
      eye_mm: [
        center[0] + distanceMm * arm[0],
        center[1] + distanceMm * arm[1],
        center[2] + distanceMm * arm[2],
      ],
      error_rad,
    },
    distanceMm,
  };
}
