// SPDX-License-Identifier: Apache-2.0
// An emulated headset (iwer) in a page: where its head and its controllers are, in meters.

import { readFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';

/** The script that gives a page a headset. */
export async function headsetScript() {
  const file = fileURLToPath(new URL('../build/iwer.min.js', import.meta.resolve('iwer')));
  const emulator = await readFile(file, 'utf8');
  return `${emulator};
    // The grip is where the controller is, instead of beside its pointing ray.
    const unit = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    for (const hand of Object.values(IWER.metaQuest3.controllerConfig.layout))
      hand.gripOffsetMatrix = unit;
    window.headset = new IWER.XRDevice(IWER.metaQuest3);
    window.headset.installRuntime({ forceInstall: true });`;
}

/** A turn about X, as a quaternion x, y, z, w. */
export function aboutX(radians) {
  return [Math.sin(radians / 2), 0, 0, Math.cos(radians / 2)];
}

/** A vector turned about X. */
export function turnedX([x, y, z], radians) {
  const [sine, cosine] = [Math.sin(radians), Math.cos(radians)];
  return [x, cosine * y - sine * z, sine * y + cosine * z];
}

export class Headset {
  constructor(page) {
    this.page = page;
  }

  state() {
    return this.page.evaluate(() => window.kerf.vr());
  }

  look(position, quaternion) {
    return this.page.evaluate(
      ([at, turn]) => {
        window.headset.position.set(...at);
        window.headset.quaternion.set(...turn);
      },
      [position, quaternion],
    );
  }

  /** Moves a controller; `buttons`: values by name, as iwer calls them. */
  hand(side, position, quaternion, buttons = {}) {
    return this.page.evaluate(
      ([hand, at, turn, values]) => {
        const controller = window.headset.controllers[hand];
        controller.position.set(...at);
        controller.quaternion.set(...turn);
        for (const [name, value] of Object.entries(values))
          controller.updateButtonValue(name, value);
      },
      [side, position, quaternion, buttons],
    );
  }

  /** Waits until so many frames have been drawn from now on. */
  async frames(count) {
    const { frames } = await this.state();
    await this.page.waitForFunction(
      (least) => (window.kerf.vr()?.frames ?? Infinity) >= least,
      frames + count,
      { polling: 50 },
    );
  }

  /** Presses a button of a controller for two frames. */
  async press(side, name) {
    const set = (value) =>
      this.page.evaluate(
        ([hand, button, to]) => window.headset.controllers[hand].updateButtonValue(button, to),
        [side, name, value],
      );
    await set(1);
    await this.frames(2);
    await set(0);
  }
}
