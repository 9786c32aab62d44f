// SPDX-License-Identifier: Apache-2.0
// The controllers of a headset: where their grips are, and which buttons have just been pressed.

import * as THREE from 'three';
import type { Grip } from './placement';

// Places in the mapping "xr-standard".
const TRIGGER = 0;
const SQUEEZE = 1;
const STICK_X = 2;
const LOWER = 4; // A or X
const UPPER = 5; // B or Y
const PULLED = 0.35;
const LET_GO = 0.25; // less than PULLED: a trigger that trembles is pulled once
const STICK_FAR = 0.7;
const STICK_BACK = 0.3;

export type Hand = 'left' | 'right';
export const HANDS: readonly Hand[] = ['left', 'right'];

export interface Controller {
  grip: Grip;
  isPulled: boolean;
  isSqueezed: boolean;
  /** Since the last frame. */
  pulled: boolean;
  lower: boolean;
  upper: boolean;
  /** The stick was pushed to the left or right since the last frame. */
  step: -1 | 0 | 1;
  source: XRInputSource;
}

interface Held {
  trigger: boolean;
  squeeze: boolean;
  lower: boolean;
  upper: boolean;
  stick: boolean;
}

function isHeld(button: GamepadButton | undefined, was: boolean): boolean {
  return (button?.value ?? 0) > (was ? LET_GO : PULLED);
}

export class Controllers {
  private readonly held_ = new Map<Hand, Held>();

  /** Reads the controllers that are tracked in a frame. */
  read(
    sources: Iterable<XRInputSource>,
    poseOf: (space: XRSpace) => XRPose | undefined,
  ): Map<Hand, Controller> {
    const found = new Map<Hand, Controller>();
    for (const source of sources) {
      const { handedness, gripSpace, gamepad } = source;
      if (handedness === 'none' || !gripSpace || !gamepad) continue;
      const pose = poseOf(gripSpace);
      if (pose) found.set(handedness, this.controller_(handedness, source, gamepad, pose));
    }
    return found;
  }

  private controller_(
    hand: Hand,
    source: XRInputSource,
    { buttons, axes }: Gamepad,
    { transform: { position: p, orientation: q } }: XRPose,
  ): Controller {
    const was = this.held_.get(hand);
    const x = axes[STICK_X] ?? 0;
    const now: Held = {
      trigger: isHeld(buttons[TRIGGER], was?.trigger ?? false),
      squeeze: isHeld(buttons[SQUEEZE], was?.squeeze ?? false),
      lower: isHeld(buttons[LOWER], was?.lower ?? false),
      upper: isHeld(buttons[UPPER], was?.upper ?? false),
      stick: Math.abs(x) > (was?.stick ? STICK_BACK : STICK_FAR),
    };
    this.held_.set(hand, now);
    return {
      grip: {
        position: new THREE.Vector3(p.x, p.y, p.z),
        quaternion: new THREE.Quaternion(q.x, q.y, q.z, q.w),
      },
      isPulled: now.trigger,
      isSqueezed: now.squeeze,
      pulled: now.trigger && !was?.trigger,
      lower: now.lower && !was?.lower,
      upper: now.upper && !was?.upper,
      step: now.stick && !was?.stick ? (Math.sign(x) as -1 | 1) : 0,
      source,
    };
  }
}
