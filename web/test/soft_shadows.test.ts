// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { ShaderChunk } from 'three';
import { withFewerSamples } from '../src/view/soft_shadows';

const GOLDEN_ANGLE = 2.399963229728653; // of three's vogelDiskSample()

describe('the code of shadows', () => {
  const before = ShaderChunk.shadowmap_pars_fragment;
  const after = withFewerSamples(before);

  it('has a loop in the place of the five samples', () => {
    const samples = (code: string): number => code.split('vogelDiskSample( ').length - 1;
    expect(samples(before) - samples(after)).toBe(5);
    expect(after).toContain('int samples = shadowRadius > 0.0 ? 5 : 1;');
  });

  it('takes them where three.js does', () => {
    const values = /mat2\( ([^)]*) \)/.exec(after)![1]!.split(', ').map(Number);
    const [a, b, c, d] = values as [number, number, number, number]; // by columns
    const phi = 0.7;
    let [x, y] = [Math.cos(phi), Math.sin(phi)];
    for (let n = 0; n < 5; ++n) {
      expect(x).toBeCloseTo(Math.cos(n * GOLDEN_ANGLE + phi), 6);
      expect(y).toBeCloseTo(Math.sin(n * GOLDEN_ANGLE + phi), 6);
      [x, y] = [a * x + c * y, b * x + d * y];
    }
  });
});
