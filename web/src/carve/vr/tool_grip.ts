// SPDX-License-Identifier: Apache-2.0
// The tool in a hand: from the pose of a controller's grip to the tool's pose in the block.

import * as THREE from 'three';
import type { Pose } from '../tool/path_queue';
import type { Grip } from './placement';

// The hand holds the tool's handle; very large and very small tools would be out of reach.
const AHEAD_OF_HANDLE = 0.75;
const AHEAD_MIN_M = 0.05;
const AHEAD_MAX_M = 0.22;

/** How far the tip is before the hand, m. `topMm`: height of the tool's handle; `scale`: m a mm. */
export function aheadM(topMm: number, scale: number): number {
  return Math.min(AHEAD_MAX_M, Math.max(AHEAD_MIN_M, AHEAD_OF_HANDLE * topMm * scale));
}

/**
 * Returns the pose in the block, mm. A rod in the hand lies along the grip's Z, its end at the thumb
 * towards -Z (WebXR, "gripSpace"): there is the tip.
 */
export function toolPose(grip: Grip, ahead: number, toPhysical: THREE.Matrix4): Pose {
  const toBlock = toPhysical.clone().invert();
  const axis = new THREE.Vector3(0, 0, 1).applyQuaternion(grip.quaternion);
  const tip = axis.clone().multiplyScalar(-ahead).add(grip.position).applyMatrix4(toBlock);
  return { tip: tip.toArray(), axis: axis.transformDirection(toBlock).toArray() };
}

/** Whether the trigger makes the tool cut, or lifts one that cuts otherwise. */
export type TriggerMode = 'cuts' | 'lifts';

export function cutsNow(mode: TriggerMode, isPulled: boolean): boolean {
  return isPulled === (mode === 'cuts');
}
