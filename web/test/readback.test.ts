// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { copyUpright, Readback } from '../src/view/readback';

/** WebGL of a 1 × 1 canvas: its work is done when the test says so. */
class SlowGl {
  readonly UNSIGNALED = 0;
  readonly canvas = new EventTarget();
  readonly drawingBufferWidth = 1;
  readonly drawingBufferHeight = 1;
  isDone = false;
  createBuffer = () => ({});
  fenceSync = () => ({});
  getSyncParameter = () => (this.isDone ? 1 : this.UNSIGNALED);
  isContextLost = () => false;
  getBufferSubData = (_target: number, _from: number, rows: Uint8Array) => rows.fill(255);
  bindBuffer = vi.fn();
  bufferData = vi.fn();
  readPixels = vi.fn();
  flush = vi.fn();
  deleteSync = vi.fn();
  deleteBuffer = vi.fn();
}

describe('pixels that were read back', () => {
  it('have the lowest row last', () => {
    const rows = new Uint8Array([1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 10, 11, 12, 255]);
    const image = new Uint8ClampedArray(16);
    copyUpright(rows, 2, image);
    expect([...image]).toEqual([7, 8, 9, 255, 10, 11, 12, 255, 1, 2, 3, 255, 4, 5, 6, 255]);
  });

  it('are not multiplied by their alpha', () => {
    const image = new Uint8ClampedArray(12);
    copyUpright(new Uint8Array([50, 100, 0, 100, 0, 0, 0, 0, 9, 9, 9, 255]), 3, image);
    expect([...image]).toEqual([128, 255, 0, 100, 0, 0, 0, 0, 9, 9, 9, 255]);
  });
});

describe('a picture that the CPU draws', () => {
  const put = vi.fn();
  const screen = {
    getContext: () => ({ canvas: { width: 1, height: 1 }, putImageData: put }),
  } as unknown as HTMLCanvasElement;
  const readbackOf = (gl: SlowGl) => new Readback(gl as unknown as WebGL2RenderingContext, screen);
  const turns = async () => {
    await vi.advanceTimersByTimeAsync(50);
  };

  beforeEach(() => {
    put.mockReset();
    vi.useFakeTimers();
    vi.stubGlobal(
      'ImageData',
      class {
        readonly data = new Uint8ClampedArray(4);
      },
    );
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.useRealTimers();
  });

  it('is waited for until it is on the screen', async () => {
    const gl = new SlowGl();
    const readback = readbackOf(gl);
    const [placed, shown] = [vi.fn(), vi.fn()];
    readback.show(placed);
    void readback.shown.then(shown);
    await turns();
    expect(readback.isBusy).toBe(true);
    expect(shown).not.toHaveBeenCalled();
    gl.isDone = true;
    await turns();
    expect(put).toHaveBeenCalledOnce();
    expect(placed).toHaveBeenCalledBefore(shown);
    expect(readback.isBusy).toBe(false);
  });

  it('is waited for no longer when it cannot be shown', async () => {
    const gl = new SlowGl();
    gl.isDone = true;
    const reported = vi.spyOn(console, 'error').mockReturnValue();
    put.mockImplementation(() => {
      throw new Error('no memory');
    });
    const readback = readbackOf(gl);
    readback.show(vi.fn());
    await turns();
    await expect(readback.shown).resolves.toBeUndefined();
    expect(reported).toHaveBeenCalledOnce();
  });
});
