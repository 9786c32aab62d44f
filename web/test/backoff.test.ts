// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Backoff } from '../src/link/backoff';

describe('backoff', () => {
  it('doubles the delay up to a limit and restarts after a reset', () => {
    const backoff = new Backoff(250, 8000, () => 1);
    expect([1, 2, 3, 4, 5, 6, 7].map(() => backoff.next())).toEqual([
      250, 500, 1000, 2000, 4000, 8000, 8000,
    ]);
    backoff.reset();
    expect(backoff.next()).toBe(250);
  });
});
