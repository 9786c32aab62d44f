// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, it, vi } from 'vitest';
import { eachFrame, frameLimit } from '../src/ui/frames';
import type { Picture } from '../src/ui/picture';
import { turn } from './support/turn';

afterEach(() => vi.unstubAllGlobals());

it('calls back in each frame, but not while a picture is being drawn', async () => {
  const asked: ((nowMs: number) => void)[] = [];
  vi.stubGlobal('requestAnimationFrame', (callback: (nowMs: number) => void) =>
    asked.push(callback),
  );
  let shown = Promise.resolve();
  const picture = { shown: () => shown } as unknown as Picture;
  const frames: number[] = [];
  eachFrame(picture, (nowMs) => frames.push(nowMs));
  expect(asked).toHaveLength(1);
  asked[0]!(16);
  await vi.waitFor(() => expect(asked).toHaveLength(2));

  let show = (): void => undefined;
  shown = new Promise((resolve) => (show = resolve));
  asked[1]!(32);
  await turn();
  expect(asked).toHaveLength(2);
  show();
  await vi.waitFor(() => expect(asked).toHaveLength(3));
  expect(frames).toEqual([16, 32]);
});

it('calls back in 20 of 60 frames per second if the address asks for that', async () => {
  let ask: ((nowMs: number) => void) | undefined;
  vi.stubGlobal('requestAnimationFrame', (callback: (nowMs: number) => void) => (ask = callback));
  const picture = { shown: () => Promise.resolve() } as unknown as Picture;
  const frames: number[] = [];
  eachFrame(
    picture,
    (nowMs) => frames.push(nowMs),
    frameLimit(new URLSearchParams('session=a&frames=20')),
  );
  // Frames of 16 or 17 ms, as browsers report them.
  for (let n = 0; n < 120; ++n) {
    ask!(1000 + Math.round((n * 1000) / 60));
    await Promise.resolve();
    await Promise.resolve();
  }
  expect(frames).toHaveLength(40);
  expect(frames.slice(0, 3)).toEqual([1000, 1050, 1100]);
});

it('draws every frame for addresses without a limit or with one out of range', () => {
  for (const search of ['', 'frames=', 'frames=0', 'frames=241', 'frames=-1', 'frames=x']) {
    expect(frameLimit(new URLSearchParams(search))).toBe(0);
  }
});
