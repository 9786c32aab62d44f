// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { rejectionText, whyNotCarve, whyNotNow } from '../../src/carve/reasons';
import type { StateMessage } from '../../src/wire/types';

describe('whyNotNow', () => {
  it('asks for both connections, the present, and a server that can write', () => {
    const state: StateMessage = {
      type: 'state',
      motions: 1,
      removed_volume_mm3: 0,
      state_hash: '',
      settled: true,
    };
    const at = { record: 1, time_ms: 0, rate: 0 };
    expect(whyNotNow({ state, status: 'connected' }, true)).toBe('');
    expect(whyNotNow({ state, status: 'connected' }, false)).toContain('Not connected');
    expect(whyNotNow({ state, status: 'reconnecting' }, true)).toContain('Not connected');
    expect(whyNotNow({ state: { ...state, at }, status: 'connected' }, true)).toContain('past');
    const paused = { ...state, paused: 'disk' as const };
    expect(whyNotNow({ state: paused, status: 'connected' }, true)).toContain('written');
    const alone = { ...state, paused: 'lease' as const };
    expect(whyNotNow({ state: alone, status: 'connected' }, true)).toContain('reach each other');
  });
});

describe('whyNotCarve', () => {
  it('names the role that may not', () => {
    expect(whyNotCarve({})).toBe('');
    expect(whyNotCarve({ may: ['watch', 'carve'], role: 'sculptor' })).toBe('');
    expect(whyNotCarve({ may: ['watch'], role: 'watcher' })).toBe(
      'Your role, watcher, does not allow carving.',
    );
  });
});

describe('rejectionText', () => {
  it('says that there is no stroke, without the number of the participant', () => {
    expect(rejectionText('participant 5 has no stroke to undo')).toBe(
      'There is no stroke to undo.',
    );
    expect(rejectionText('participant 12 has no stroke to redo')).toBe(
      'There is no stroke to redo.',
    );
    expect(rejectionText('the tool is muted')).toBe('the tool is muted');
  });
});
