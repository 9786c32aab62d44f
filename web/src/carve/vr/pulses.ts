// SPDX-License-Identifier: Apache-2.0
// The force on the tool as pulses of the controller that holds it.

const EVERY_MS = 25;
const LEAST = 0.02; // of the full force

interface Actuator {
  pulse?: (strength: number, durationMs: number) => Promise<unknown>;
}

export class Pulses {
  private nextMs_ = 0;
  /** How many there were. */
  count = 0;

  /** `share`: of the full force; the strength is that, at most 1. */
  feel(gamepad: Gamepad | undefined, share: number, nowMs: number): void {
    if (share < LEAST || nowMs < this.nextMs_) return;
    // In the type of browsers' gamepads only `vibrationActuator` is left, which headsets lack.
    const { hapticActuators } = (gamepad ?? {}) as { hapticActuators?: Actuator[] };
    const pulse = hapticActuators?.[0]?.pulse?.(Math.min(1, share), 2 * EVERY_MS);
    if (!pulse) return;
    this.nextMs_ = nowMs + EVERY_MS;
    this.count += 1;
    void pulse.catch(() => undefined); // one that refuses is no loss
  }
}
