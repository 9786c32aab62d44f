// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { viewerName } from '../src/link/viewer_name';

describe('the name of a viewer', () => {
  let stored: Map<string, string>;

  beforeEach(() => {
    stored = new Map();
    vi.stubGlobal('localStorage', {
      getItem: (key: string) => stored.get(key) ?? null,
      setItem: (key: string, value: string) => stored.set(key, value),
    });
  });
  afterEach(() => vi.unstubAllGlobals());

  const named = (query: string): string => viewerName(new URLSearchParams(query));

  it('is that of the address, which counts for this visit only', () => {
    stored.set('kerf.name', 'Ada');
    expect(named('name=%20Grace%20')).toBe('Grace');
    expect(stored.get('kerf.name')).toBe('Ada');
  });

  it('is else the one used last', () => {
    stored.set('kerf.name', 'Ada');
    expect(named('')).toBe('Ada');
    expect(named('name=%20')).toBe('Ada');
  });

  it("is else a guest's, which is kept", () => {
    const guest = named('');
    expect(guest).toMatch(/^Guest [1-9]\d\d$/);
    expect(named('')).toBe(guest);
  });

  it("is truncated to the server's limit", () => {
    expect(named(`name=${'x'.repeat(70)}`)).toBe('x'.repeat(64));
  });
});
