// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { copyUpright } from '../src/view/readback';

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
