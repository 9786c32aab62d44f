// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import { describe, expect, it } from 'vitest';
import { Controllers } from '../../../src/carve/vr/controllers';
import type { Controller } from '../../../src/carve/vr/controllers';
import { FrameMeter } from '../../../src/carve/vr/frame_meter';
import { Pulses } from '../../../src/carve/vr/pulses';
import { aheadM, cutsNow, toolPose } from '../../../src/carve/vr/tool_grip';

const POSE = {
  transform: { position: { x: 1, y: 2, z: 3 }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
} as unknown as XRPose;

function right(trigger: number, others: { stick?: number; lower?: number } = {}): XRInputSource {
  const buttons = [trigger, 0, 0, 0, others.lower ?? 0, 0].map((value) => ({ value }));
  const gamepad = { buttons, axes: [0, 0, others.stick ?? 0, 0] };
  return { handedness: 'right', gripSpace: {}, gamepad } as unknown as XRInputSource;
}

describe('Controllers', () => {
  const read = (controllers: Controllers, source: XRInputSource): Controller =>
    controllers.read([source], () => POSE).get('right')!;

  it('tell a press once, though the trigger trembles', () => {
    const controllers = new Controllers();
    const pulled = [0, 0.3, 0.4, 0.3, 0.4, 0.1, 0.3].map((value) => {
      const { isPulled, pulled: now } = read(controllers, right(value));
      return [isPulled, now];
    });
    const [no, began, goes] = [
      [false, false],
      [true, true],
      [true, false],
    ];
    expect(pulled).toEqual([no, no, began, goes, goes, no, no]);
  });

  it('step once each time the stick is pushed', () => {
    const controllers = new Controllers();
    const steps = [0, -0.9, -1, -0.4, -0.9, 0, 0.8].map(
      (stick) => read(controllers, right(0, { stick })).step,
    );
    expect(steps).toEqual([0, -1, 0, 0, 0, 0, 1]);
  });

  it('leave out untracked controllers, and hands without buttons', () => {
    const controllers = new Controllers();
    expect(controllers.read([right(1)], () => undefined).size).toBe(0);
    const hand = { handedness: 'left', gripSpace: {} } as unknown as XRInputSource;
    expect(controllers.read([hand], () => POSE).size).toBe(0);
  });
});

describe('the tool in the hand', () => {
  it('has its tip before the hand, and its axis along the rod that the hand would hold', () => {
    const toPhysical = new THREE.Matrix4().compose(
      new THREE.Vector3(0, 1, 0),
      new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(1, 0, 0), -Math.PI / 2),
      new THREE.Vector3().setScalar(0.01),
    );
    // The rod points down: its thumb end, the grip's -Z, to physical -Y.
    const quaternion = new THREE.Quaternion().setFromAxisAngle(
      new THREE.Vector3(1, 0, 0),
      -Math.PI / 2,
    );
    const { tip, axis } = toolPose(
      { position: new THREE.Vector3(0.1, 1.3, -0.2), quaternion },
      0.1,
      toPhysical,
    );
    [10, 20, 20].forEach((mm, i) => expect(tip[i]).toBeCloseTo(mm, 9));
    [0, 0, 1].forEach((part, i) => expect(axis[i]).toBeCloseTo(part, 12));
  });

  it('is held at its handle, but neither too near nor out of reach', () => {
    expect(aheadM(60, 0.002)).toBeCloseTo(0.09, 12);
    expect(aheadM(60, 1e-5)).toBe(0.05);
    expect(aheadM(60, 0.1)).toBe(0.22);
  });

  it('cuts with the trigger, or without it', () => {
    expect(cutsNow('cuts', true) && cutsNow('lifts', false)).toBe(true);
    expect(cutsNow('cuts', false) || cutsNow('lifts', true)).toBe(false);
  });
});

describe('Pulses', () => {
  function pad(): { gamepad: Gamepad; pulses: [number, number][] } {
    const pulses: [number, number][] = [];
    const pulse = (strength: number, ms: number): Promise<boolean> => {
      pulses.push([strength, ms]);
      return Promise.resolve(true);
    };
    return { gamepad: { hapticActuators: [{ pulse }] } as unknown as Gamepad, pulses };
  }

  it('are as strong as the force, and overlap', () => {
    const { gamepad, pulses } = pad();
    const felt = new Pulses();
    for (let ms = 0; ms < 100; ms += 5) felt.feel(gamepad, ms < 50 ? 0.5 : 3, ms);
    expect(pulses.map(([strength]) => strength)).toEqual([0.5, 0.5, 1, 1]);
    expect(pulses.every(([, ms]) => ms === 50)).toBe(true);
  });

  it('stop without a force, and are missed by no controller that has none', () => {
    const { gamepad, pulses } = pad();
    const felt = new Pulses();
    felt.feel(gamepad, 0.01, 0);
    felt.feel(undefined, 1, 0);
    expect([pulses.length, felt.count]).toEqual([0, 0]);
  });
});

describe('FrameMeter', () => {
  it('tells the middle and the worst of the newest frames', () => {
    const meter = new FrameMeter();
    for (let n = 0; n < 1000; n += 1) meter.add(n < 488 ? 1000 : n % 100, 7, n);
    const { frames, p50Ms, p95Ms, calls, triangles } = meter.cost;
    expect([frames, calls, triangles]).toEqual([1000, 7, 999]);
    expect(p50Ms).toBeGreaterThan(45);
    expect(p50Ms).toBeLessThan(55);
    expect(p95Ms).toBeLessThan(100);
  });
});
