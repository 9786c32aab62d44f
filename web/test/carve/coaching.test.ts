// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { beforeEach, describe, expect, it } from 'vitest';
import { Coaching } from '../../src/carve/coaching';

describe('the line of coaching', () => {
  beforeEach(() => {
    localStorage.clear();
  });
  const make = (isTouched = false): Coaching => new Coaching(() => isTouched);

  it('says how to carve until the first stroke, then how to reach the sides until the first lean', () => {
    const coaching = make();
    expect(coaching.text).toBe('Drag on the block to carve.');
    coaching.stroked();
    expect(coaching.text).toMatch(/sides/);
    coaching.stroked();
    expect(coaching.text).toMatch(/sides/);
    coaching.leaned();
    expect(coaching.text).toBe('');
    coaching.stroked();
    expect(coaching.text).toBe('');
  });

  it('goes on where it was in a page that is loaded again', () => {
    make().stroked();
    expect(make().text).toMatch(/sides/);
    make().leaned();
    expect(make().text).toBe('');
  });

  it('names fingers where there are some', () => {
    const coaching = make(true);
    expect(coaching.text).toMatch(/finger/);
    coaching.stroked();
    expect(coaching.text).toMatch(/fingers/);
  });
});
