// SPDX-License-Identifier: Apache-2.0
// The cut as vibration, of a phone and of gamepads, where there is one.

const EVERY_MS = 60;
const LEAST = 0.04; // of the full force

export class Rumble {
  private nextMs_ = 0;

  /** `share`: of the full force, 0 to 1; `inHand`: the device that is touched is the one that vibrates. */
  feel(share: number, inHand: boolean, nowMs: number): void {
    if (share < LEAST || nowMs < this.nextMs_) return;
    this.nextMs_ = nowMs + EVERY_MS;
    const strength = Math.min(1, share);
    if (inHand && 'vibrate' in navigator) navigator.vibrate(Math.round(6 + 30 * strength));
    for (const pad of navigator.getGamepads()) {
      // Only some browsers have actuators; one that refuses is no loss.
      const actuator = pad?.vibrationActuator as GamepadHapticActuator | null | undefined;
      void actuator
        ?.playEffect('dual-rumble', {
          duration: 2 * EVERY_MS,
          strongMagnitude: strength,
          weakMagnitude: 0.5 * strength,
        })
        .catch(() => undefined);
    }
  }
}
