// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { FrameWatch } from '../src/link/frame_watch';
import { PictureLag } from '../src/model/picture_lag';
import { MESH_SUMMED } from '../src/wire/checksum';
import type { Header, StateMessage } from '../src/wire/types';

const header = (sequence: number, flags = MESH_SUMMED): Header => {
  return { type: 3, flags, epoch: 1, sequence: BigInt(sequence), time_us: 0n };
};

function watchAfter(meshes: number, ...sequences: number[]): FrameWatch {
  const watch = new FrameWatch();
  watch.begin(meshes);
  for (const sequence of sequences) expect(watch.isNext(header(sequence))).toBe(true);
  return watch;
}

describe('frame watch', () => {
  it('takes frames in order, also behind those of a block before', () => {
    watchAfter(0, 1, 2, 3);
    watchAfter(17, 18, 19);
  });

  it.each([1, 2, 4, 9])('does not take frame %i for the third', (sequence) => {
    expect(watchAfter(0, 1, 2).isNext(header(sequence))).toBe(false);
  });

  it('does not take a frame without a checksum', () => {
    expect(watchAfter(0, 1).isNext(header(2, 0))).toBe(false);
  });

  it('is late while a frame is missing that was sent before a pong, and then lost', () => {
    const watch = watchAfter(0, 1);
    watch.sent(1n);
    expect(watch.isLate).toBe(false);
    watch.sent(2n);
    expect(watch.isLate).toBe(true);
    expect(watch.isNext(header(2))).toBe(true);
    watch.sent(2n);
    expect(watch.isLate).toBe(false);
    for (let pong = 0; pong < 5; ++pong) {
      expect(watch.isLost).toBe(false);
      watch.sent(3n);
    }
    expect(watch.isLost).toBe(true);
  });

  it('expects nothing of a server that does not say which frames it sends', () => {
    const watch = new FrameWatch();
    watch.begin(undefined);
    expect(watch.watches).toBe(false);
    for (const sequence of [1, 5, 3]) expect(watch.isNext(header(sequence, 0))).toBe(true);
    watch.sent(0n);
    expect(watch.isLate).toBe(false);
  });
});

describe('lag of the picture', () => {
  const state = (motions: number, settled = false): StateMessage => {
    return { type: 'state', motions, removed_volume_mm3: 0, state_hash: '', settled };
  };

  it('is behind when tiles are awaited for more than three seconds', () => {
    const lag = new PictureLag();
    lag.pictured(10);
    lag.heard(state(12), 1000);
    lag.heard(state(20), 3500); // does not begin again
    expect(lag.isBehind(4000)).toBe(false);
    expect(lag.isBehind(4001)).toBe(true);
    lag.pictured(11);
    expect(lag.isBehind(4001)).toBe(true);
    lag.pictured(12);
    expect(lag.isBehind(4001)).toBe(false);
  });

  it('is not behind when motions have changed no tile, or the past is shown', () => {
    const lag = new PictureLag();
    lag.heard(state(12), 0);
    lag.heard(state(13, true), 100);
    expect(lag.isBehind(9000)).toBe(false);
    lag.heard({ ...state(15), at: { record: 3, time_ms: 0, rate: 1 } }, 9000);
    expect(lag.isBehind(20_000)).toBe(false);
    lag.isMissing = true;
    expect(lag.isBehind(0)).toBe(true);
    lag.reset();
    expect(lag.isBehind(0)).toBe(false);
  });
});
