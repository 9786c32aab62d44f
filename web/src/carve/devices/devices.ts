// SPDX-License-Identifier: Apache-2.0
// Gamepads and 3D mice move the tool in the mode that is called free: anywhere, with any axis. The
// pointer goes on as before when they rest.

import { plus } from '../../model/vector';
import type { Vec3 } from '../../wire/types';
import type { Pose } from '../tool/path_queue';
import type { Wielded } from '../tool/wielded';
import { isAtRest, moved } from './deflection';
import type { Deflection, Sides } from './deflection';
import { GamepadReader } from './gamepad';
import type { Press } from './gamepad';
import type { SpaceMouse } from './space_mouse';

const SLOWEST_S = 0.05; // a page that stood still does not jump
const DIAGONALS_PER_S = 0.5;

export interface DevicesHost {
  wielded: Wielded;
  /** Of the picture. */
  sides: () => Sides;
  /** Where a tool begins that is nowhere, mm: over the middle of the block. */
  start: () => Vec3;
  diagonalMm: () => number;
}

export class Devices {
  private readonly readers_ = new Map<number, GamepadReader>();
  /** Where the tool is before it is pressed down; null: no device moves it. */
  private above_: Pose | null = null;
  private lastMs_ = 0;

  constructor(
    private readonly host: DevicesHost,
    private readonly mouse: Pick<SpaceMouse, 'read'>,
  ) {}

  /** Moves the tool as the devices say, since the last call. */
  tick(nowMs: number): void {
    const timeS = Math.min(SLOWEST_S, (nowMs - this.lastMs_) / 1000);
    this.lastMs_ = nowMs;
    const read = [this.mouse.read(), ...this.pads_()];
    for (const { presses } of read) for (const press of presses) this.press_(press);
    const active = read.find((one) => !isAtRest(one));
    if (active) this.move_(active, timeS);
    else if (this.above_) this.rest_();
  }

  private *pads_(): Generator<Deflection & { presses: Press[] }> {
    for (const pad of navigator.getGamepads()) {
      if (pad?.mapping !== 'standard') continue; // the button layouts of other mappings are unknown
      let reader = this.readers_.get(pad.index);
      if (!reader) this.readers_.set(pad.index, (reader = new GamepadReader()));
      yield reader.read(pad);
    }
  }

  private move_(by: Deflection, timeS: number): void {
    const { wielded } = this.host;
    const speed = DIAGONALS_PER_S * this.host.diagonalMm();
    const from = this.above_ ?? wielded.pose() ?? { tip: this.host.start(), axis: [0, 0, 1] };
    const above = moved(from, by, this.host.sides(), timeS, speed);
    this.above_ = above;
    const reason = by.press > 0 ? wielded.whyNot() : '';
    if (reason !== '') wielded.say(reason);
    const cuts = by.press > 0 && reason === '';
    const depth = by.press * wielded.settings.depthMm;
    if (!cuts) wielded.lift();
    wielded.moveTo({ tip: plus(above.tip, above.axis, -depth), axis: above.axis }, cuts);
  }

  /** Lifts the tool to where it was before it was pressed. */
  private rest_(): void {
    const { wielded } = this.host;
    wielded.lift();
    if (this.above_) wielded.moveTo(this.above_, false);
    this.above_ = null;
  }

  private press_(press: Press): void {
    const { wielded } = this.host;
    switch (press) {
      case 'undo':
        wielded.undo();
        return;
      case 'redo':
        wielded.redo();
        return;
      case 'next':
        wielded.settings.nextTool(1);
        return;
      case 'before':
        wielded.settings.nextTool(-1);
    }
  }
}
