// SPDX-License-Identifier: Apache-2.0
// A 3D mouse that sends reports as the USB device does.

import type { Hid } from '../../src/carve/devices/space_mouse';

type Listener = (report: { reportId: number; data: DataView }) => void;

export interface FakeMouse {
  hid: Hid;
  report: (id: number, ...bytes: number[]) => void;
  /** Plugs it in, or pulls it out. */
  plug: (isIn: boolean) => void;
}

/** @param chosen whether the user chooses it, when asked */
export function fakeMouse(isAllowed = true, chosen = true): FakeMouse {
  const makeDevice = (): {
    opened: boolean;
    listeners: Listener[];
    open: () => Promise<void>;
    addEventListener: (type: string, act: Listener) => void;
  } => {
    const listeners: Listener[] = [];
    return {
      opened: false,
      listeners,
      open: () => Promise.resolve(),
      addEventListener: (_, act) => listeners.push(act),
    };
  };
  let device = makeDevice();
  const acts: Record<string, (event: { device: typeof device }) => void> = {};
  return {
    hid: {
      getDevices: () => Promise.resolve(isAllowed ? [device] : []),
      requestDevice: () => Promise.resolve(chosen ? [device] : []),
      addEventListener: (type, act) => (acts[type] = act),
    },
    report: (reportId, ...bytes) => {
      const data = new DataView(new Uint8Array(bytes).buffer);
      for (const act of device.listeners) act({ reportId, data });
    },
    plug: (isIn) => {
      if (isIn) device = makeDevice();
      acts[isIn ? 'connect' : 'disconnect']?.({ device });
    },
  };
}
