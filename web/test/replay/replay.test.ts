// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { SPAN_RECORDS, spansOf } from '../../src/link/replay';
import { compared } from '../../src/replay/check';

describe('the spans of a journal', () => {
  it('begin where everybody asks for them, so that caches have them', () => {
    const N = SPAN_RECORDS;
    expect(spansOf(0, 10)).toEqual([{ first: 1, last: 10 }]);
    expect(spansOf(0, 2 * N + 3)).toEqual([
      { first: 1, last: N },
      { first: N + 1, last: 2 * N },
      { first: 2 * N + 1, last: 2 * N + 3 },
    ]);
    expect(spansOf(N - 5, N + 5)).toEqual([
      { first: 1, last: N },
      { first: N + 1, last: N + 5 },
    ]);
    expect(spansOf(7, 7)).toEqual([]);
  });
});

describe('a replay', () => {
  const server = { journal: 'j', record: 20, state_hash: 'abc' };
  it('is verified by the hash after the record of the server only', () => {
    expect(compared(server, 20, 'abc').is).toBe('verified');
    expect(compared(server, 20, 'abd')).toMatchObject({ is: 'different', serverHash: 'abc' });
    expect(compared(server, 19, 'abc').is).toBe('different');
  });
});
