// SPDX-License-Identifier: Apache-2.0
// A 3D mouse (SpaceMouse, SpaceNavigator) by WebHID: its cap moves and leans the tool, its left button
// presses it, its right one takes the next tool. Without a tool in hand it moves the camera
// (`cap_mouse.tsx`).

import type { Vec3 } from '../../wire/types';
import { AT_REST, eased } from './deflection';
import type { Deflection } from './deflection';
import type { Press } from './gamepad';

// The part of WebHID that is used; TypeScript's library has none of it.
interface HidReport {
  reportId: number;
  data: DataView;
}
interface HidDevice {
  opened: boolean;
  open: () => Promise<void>;
  addEventListener: (type: 'inputreport', act: (report: HidReport) => void) => void;
}
export interface Hid {
  getDevices: () => Promise<HidDevice[]>;
  requestDevice: (options: { filters: object[] }) => Promise<HidDevice[]>;
  addEventListener: (
    type: 'connect' | 'disconnect',
    act: (event: { device: HidDevice }) => void,
  ) => void;
}

// Logitech sold them at first. Usage 8 of the generic desktop page: multi-axis controller.
const FILTERS = [0x046d, 0x256f].map((vendorId) => ({ vendorId, usagePage: 1, usage: 8 }));
const [TRANSLATION, ROTATION, BUTTONS] = [1, 2, 3]; // reports
const FULL = 350; // of each axis
const DEAD = 0.03;
const LEFT = 1; // bits of the buttons
const RIGHT = 2;

export class SpaceMouse {
  private move_: Vec3 = [0, 0, 0];
  private lean_: [number, number] = [0, 0];
  private twist_ = 0;
  private buttons_ = 0;
  private presses_: Press[] = [];
  private readonly known_ = new Set<HidDevice>();

  constructor(private readonly hid: Hid | undefined = (navigator as { hid?: Hid }).hid) {
    hid?.addEventListener('disconnect', ({ device }) => this.unplugged_(device));
    hid?.addEventListener('connect', () => void this.open(false));
  }

  /** Whether the browser can have one. */
  get canBe(): boolean {
    return this.hid !== undefined;
  }

  /** Whether one is open. */
  get isThere(): boolean {
    return this.known_.size > 0;
  }

  /** Opens those that the user has allowed before; `asks`: lets the user choose one, after a press. */
  async open(asks: boolean): Promise<void> {
    const { hid } = this;
    const found = asks ? hid?.requestDevice({ filters: FILTERS }) : hid?.getDevices();
    for (const device of (await found) ?? []) {
      if (this.known_.has(device)) continue;
      if (!device.opened) await device.open();
      device.addEventListener('inputreport', (report) => this.received_(report));
      this.known_.add(device);
    }
  }

  /** `twist`: of the cap, clockwise as seen from above, -1 to 1. */
  read(): Deflection & { twist: number; presses: Press[] } {
    const { move_: move, lean_: lean, twist_: twist, buttons_: buttons, presses_: presses } = this;
    this.presses_ = [];
    return { ...AT_REST, move, lean, twist, press: buttons & LEFT ? 1 : 0, presses };
  }

  /** It says no more that it was let go. */
  private unplugged_(device: HidDevice): void {
    if (!this.known_.delete(device)) return;
    this.move_ = [0, 0, 0];
    this.turned_(0, 0, 0);
    this.buttons_ = 0;
  }

  /** Axes are 16 bits: right, towards the user and down; then about these. */
  private received_({ reportId, data }: HidReport): void {
    const axis = (n: number): number => eased(data.getInt16(2 * n, true) / FULL, DEAD);
    if (reportId === TRANSLATION && data.byteLength >= 6) {
      this.move_ = [axis(0), -axis(2), axis(1)];
      if (data.byteLength >= 12) this.turned_(axis(3), axis(4), axis(5)); // newer ones have one report
    } else if (reportId === ROTATION && data.byteLength >= 6) {
      this.turned_(axis(0), axis(1), axis(2));
    } else if (reportId === BUTTONS && data.byteLength >= 1) {
      const now = data.getUint8(0);
      if (now & ~this.buttons_ & RIGHT) this.presses_.push('next');
      this.buttons_ = now;
    }
  }

  /** About the axis to the right the upper end goes towards the user, about that one to the left. */
  private turned_(aboutRight: number, aboutTowards: number, aboutDown: number): void {
    this.lean_ = [-aboutTowards, aboutRight];
    this.twist_ = aboutDown;
  }
}
