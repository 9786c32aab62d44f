// SPDX-License-Identifier: Apache-2.0
// A gamepad of the browser's mapping "standard": sticks move and lean the tool, a trigger presses it.

import { eased } from './deflection';
import type { Deflection } from './deflection';

const [B, Y, LEFT_SHOULDER, RIGHT_SHOULDER, RIGHT_TRIGGER, PAD_LEFT, PAD_RIGHT] = [
  1, 3, 4, 5, 7, 14, 15,
];
const PRESSED = 0.05; // of a trigger

/** The action of a button. */
export type Press = 'undo' | 'redo' | 'next' | 'before';
const PRESSES: readonly [number, Press][] = [
  [B, 'undo'],
  [Y, 'redo'],
  [PAD_RIGHT, 'next'],
  [PAD_LEFT, 'before'],
];

export class GamepadReader {
  private held_ = new Set<Press>();

  /** `pad`: as it is now. Returns which buttons were pressed since the last call. */
  read({ axes, buttons }: Pick<Gamepad, 'axes' | 'buttons'>): Deflection & { presses: Press[] } {
    const axis = (n: number): number => eased(axes[n] ?? 0);
    const button = (n: number): number => buttons[n]?.value ?? 0;
    const now = new Set(PRESSES.filter(([n]) => button(n) > 0.5).map(([, press]) => press));
    const presses = [...now].filter((press) => !this.held_.has(press));
    this.held_ = now;
    const trigger = button(RIGHT_TRIGGER);
    return {
      move: [axis(0), button(RIGHT_SHOULDER) - button(LEFT_SHOULDER), axis(1)],
      lean: [axis(2), axis(3)],
      press: trigger > PRESSED ? trigger : 0,
      presses,
    };
  }
}
