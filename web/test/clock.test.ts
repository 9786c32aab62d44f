// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { RateMeter, ServerClock } from '../src/model/clock';

describe('server clock', () => {
  it('maps server times to local times by the fastest frames, for any offset', () => {
    const clock = new ServerClock();
    const offsetMs = 123456;
    for (let i = 0; i < 50; ++i)
      clock.arrived(
        1000 + i * 20 + (i % 5),
        BigInt(Math.round((1000 + i * 20 - offsetMs + 1e6) * 1000)),
      );
    const serverUs = BigInt(Math.round((2000 - offsetMs + 1e6) * 1000));
    expect(clock.toLocalMs(serverUs)).toBeCloseTo(2000, 6);
  });

  it('separates the age of a frame from the clock offset by ping pairs', () => {
    const clock = new ServerClock();
    expect(clock.ageMs(0, 0n)).toBeNaN();
    clock.pong(1000, 1040, 5_020_000n); // server is 4000 ms ahead, 20 ms per direction
    expect(clock.rttMs).toBeCloseTo(40, 9);
    expect(clock.ageMs(1100, 5_070_000n)).toBeCloseTo(30, 6);
  });

  it('prefers the fastest ping pair', () => {
    const clock = new ServerClock();
    clock.pong(0, 10, 1_000_005_000n);
    clock.pong(100, 900, 1_000_100_100n); // a slow, asymmetric pair must not change the offset
    expect(clock.ageMs(1000, 1_000_900_000n)).toBeCloseTo(100, 3);
  });

  it('counts the events of the last second', () => {
    const meter = new RateMeter();
    for (let t = 0; t < 5000; t += 50) meter.tick(t);
    expect(meter.perSecond(4950)).toBe(20);
    expect(meter.perSecond(9000)).toBe(0);
  });
});
