// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { beforeEach, describe, expect, it, vi } from 'vitest';
import type * as KeptPerson from '../src/link/kept_person';

/** The module of a page that is loaded. */
async function load(): Promise<typeof KeptPerson> {
  vi.resetModules();
  return import('../src/link/kept_person');
}
const leave = (): boolean => window.dispatchEvent(new Event('pagehide'));
const ADA = { color: '#112233', token: 'ab12' };

describe('the person that a page keeps for the next one', () => {
  beforeEach(() => {
    sessionStorage.clear();
  });

  it('has color and token in the page that is loaded again', async () => {
    const before = await load();
    before.personIn('s');
    before.notePerson('s', ADA);
    leave();
    expect((await load()).personIn('s')).toMatchObject(ADA);
  });

  it('is nobody in another session', async () => {
    const before = await load();
    before.personIn('s');
    before.notePerson('s', ADA);
    leave();
    expect((await load()).personIn('other')).toMatchObject({ color: '', token: '' });
  });

  it('is in no storage while its page is open, so that a copy of the tab is somebody else', async () => {
    const before = await load();
    before.personIn('s');
    before.notePerson('s', ADA);
    leave();
    const after = await load();
    after.personIn('s');
    expect(sessionStorage.length).toBe(0);
    leave();
    expect(sessionStorage.length).toBe(1);
  });

  it('is nobody where the storage has something else', async () => {
    sessionStorage.setItem('kerf.person', 'no JSON');
    expect((await load()).personIn('s').token).toBe('');
  });
});
