// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Quality } from '../src/model/quality';

describe('quality', () => {
  it('steps down on slow frames and up again only after many fast ones', () => {
    const quality = new Quality(2);
    expect(quality.movingRatio).toBe(2);
    for (let i = 0; i < 6; ++i) quality.frame(60);
    const lowered = quality.movingRatio;
    expect(lowered).toBeLessThan(2);
    for (let i = 0; i < 20; ++i) quality.frame(8);
    expect(quality.movingRatio).toBe(lowered);
    for (let i = 0; i < 100; ++i) quality.frame(8);
    expect(quality.movingRatio).toBe(2);
    expect(quality.stillRatio).toBe(2);
  });

  it('has a minimum and ignores the pause of a background tab', () => {
    const quality = new Quality(1);
    for (let i = 0; i < 50; ++i) quality.frame(5000);
    expect(quality.movingRatio).toBe(1);
    for (let i = 0; i < 1000; ++i) quality.frame(60);
    expect(quality.movingRatio).toBeGreaterThan(0.2);
  });
});

describe('quality on a very slow device', () => {
  it('pauses between frames until the picture stands still', () => {
    const quality = new Quality(1, true);
    expect(quality.pauseMs).toBe(0);
    for (let i = 0; i < 60; ++i) quality.frame(200);
    expect(quality.pauseMs).toBeGreaterThan(50);
    quality.rested();
    expect(quality.pauseMs).toBe(0);
  });
});

describe('shadows of a moving picture', () => {
  it('are drawn at once, but at times on a slow device, and with hard edges there', () => {
    const takenBy = (quality: Quality): number[] =>
      [1900, 2100, 2200, 4000, 4200].filter((nowMs) => quality.takesShadows(nowMs));
    expect(takenBy(new Quality(1))).toEqual([1900, 2100, 2200, 4000, 4200]);
    expect(takenBy(new Quality(1, true))).toEqual([2100, 4200]);
    expect(new Quality(1).isSlow).toBe(false);
    expect(new Quality(1, true).isSlow).toBe(true);
  });
});

describe('a still picture', () => {
  it('waits longer after one that was soon replaced, at most two seconds', () => {
    const quality = new Quality(1);
    const after = (): number => quality.stillAfterMs;
    const first = after();
    quality.moved(50);
    const second = after();
    expect(second).toBeGreaterThan(first);
    for (let i = 0; i < 9; ++i) quality.moved(50);
    expect(after()).toBeGreaterThan(second);
    expect(after()).toBeLessThan(2100);
    quality.moved(3000);
    expect(after()).toBe(first);
  });
});
