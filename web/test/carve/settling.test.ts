// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from 'vitest';
import { Settling } from '../../src/carve/settling';
import type { StateMessage } from '../../src/wire/types';

function state(motions: number, settled = true): StateMessage {
  return { type: 'state', motions, removed_volume_mm3: 0, state_hash: '', settled };
}

describe('settling', () => {
  let log: string[];
  let settling: Settling;
  let now: number;

  beforeEach(() => {
    log = [];
    now = 0;
    settling = new Settling(
      { settle: () => log.push('copy') },
      { settled: (motions) => log.push(`settled ${motions}`) },
    );
  });

  /** Steps through a second and more. */
  function pass(message: StateMessage | null, isAsking = false): void {
    for (const until = now + 1200; now < until; now += 100) settling.step(message, isAsking, now);
  }

  it('waits until the block has rested', () => {
    pass(null);
    pass(state(3, false));
    const rests = state(4);
    settling.step(rests, false, now);
    pass(rests);
    expect(log).toEqual(['settled 4']);
    settling.step(state(5), false, now + 5000);
    expect(log).toHaveLength(1);
  });

  it('waits for a state of after the answer to an undo', () => {
    const before = state(4);
    pass(before);
    log = [];
    pass(before, true);
    pass(before);
    expect(log).toEqual([]);
    const after = state(4);
    pass(after);
    pass(after);
    expect(log.filter((what) => what === 'copy')).toHaveLength(1);
    expect(log.at(-1)).toBe('settled 4');
  });
});
