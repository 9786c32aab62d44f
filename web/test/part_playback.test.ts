// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { PartPlayback } from '../src/model/part_playback';

describe('the playback of a part of the journal', () => {
  it('goes from the record before the part to its last one', () => {
    const part = new PartPlayback(11, 50, 1000);
    expect(part.recordAt(1000)).toBe(10);
    expect(part.isOver(1000)).toBe(false);
    expect(part.recordAt(6000)).toBe(30);
    expect(part.recordAt(11_000)).toBe(50);
    expect(part.isOver(11_000)).toBe(true);
    expect(part.recordAt(99_000)).toBe(50);
  });

  it('takes 2 s for a few records and 20 s for a million', () => {
    for (const [records, ms] of [
      [1, 2000],
      [1_000_000, 20_000],
    ] as const) {
      const part = new PartPlayback(1, records, 0);
      expect(part.isOver(ms - 1)).toBe(false);
      expect(part.isOver(ms)).toBe(true);
    }
  });

  it('never goes back', () => {
    const part = new PartPlayback(5, 4711, 0);
    let before = 4;
    for (let ms = 0; ms <= 20_000; ms += 7) {
      const record = part.recordAt(ms);
      expect(record).toBeGreaterThanOrEqual(before);
      before = record;
    }
    expect(before).toBeLessThanOrEqual(4711);
  });
});
