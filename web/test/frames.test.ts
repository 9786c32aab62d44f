// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, it, vi } from 'vitest';
import { eachFrame } from '../src/ui/frames';
import type { Picture } from '../src/ui/picture';

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
  await new Promise((resolve) => setTimeout(resolve));
  expect(asked).toHaveLength(2);
  show();
  await vi.waitFor(() => expect(asked).toHaveLength(3));
  expect(frames).toEqual([16, 32]);
});
