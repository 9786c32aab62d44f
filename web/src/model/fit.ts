// SPDX-License-Identifier: Apache-2.0
// Camera position from which a whole box is in view. Needs no three.js, so that the server learns
// where the page will look from before the GPU is ready.

import type { Bounds } from './session';

type V = readonly [number, number, number];

/** Vertical field of view, degrees. */
export const FOV_DEG = 30;
/** Towards the camera in the default view. */
export const ISO_DIRECTION: V = [-0.45, -1, 1.42];
/** Space around the box. */
export const MARGIN = 1.03;
const FREE_MIN_PX = 80; // panels may cover everything

/** Widths of the picture's margins that panels cover, CSS pixels. */
export interface Insets {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** Size of the picture, CSS pixels. */
export interface Viewport {
  width: number;
  height: number;
  insets: Insets;
}

function dot(a: V, b: V): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a: V, b: V): [number, number, number] {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function unit(a: V): [number, number, number] {
  const length = Math.hypot(...a) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
}

export function boxCenter({ min, max }: Bounds): [number, number, number] {
  return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
}

/**
 * Returns the smallest distance from the box's center, along the unit vector `towardsCamera`, at
 * which all eight corners lie inside the view frustum, given by the tangents of its half angles. Z
 * points up in the picture.
 */
export function fitDistance(
  bounds: Bounds,
  towardsCamera: V,
  tanHalfWidth: number,
  tanHalfHeight: number,
): number {
  const center = boxCenter(bounds);
  const side = unit(cross([0, 0, 1], towardsCamera));
  const up = cross(towardsCamera, side);
  let distance = 0;
  for (let corner = 0; corner < 8; ++corner) {
    const arm: V = [
      (corner & 1 ? bounds.max[0] : bounds.min[0]) - center[0],
      (corner & 2 ? bounds.max[1] : bounds.min[1]) - center[1],
      (corner & 4 ? bounds.max[2] : bounds.min[2]) - center[2],
    ];
    const nearer = dot(arm, towardsCamera);
    distance = Math.max(
      distance,
      nearer + Math.abs(dot(arm, side)) / tanHalfWidth,
      nearer + Math.abs(dot(arm, up)) / tanHalfHeight,
    );
  }
  return distance;
}

/**
 * Returns the distance from the box's center, along the unit vector `towardsCamera`, at which the box
 * fills the part of the picture that no panel covers.
 */
export function viewDistance(bounds: Bounds, towardsCamera: V, view: Viewport): number {
  const { width, height, insets } = view;
  const tangent = Math.tan((FOV_DEG * Math.PI) / 360);
  const free = (of: number, covered: number): number =>
    (tangent * Math.max(FREE_MIN_PX, of - covered)) / height;
  return (
    MARGIN *
    fitDistance(
      bounds,
      towardsCamera,
      free(width, insets.left + insets.right),
      free(height, insets.top + insets.bottom),
    )
  );
}
