// SPDX-License-Identifier: Apache-2.0
import { afterEach, describe, expect, it, vi } from 'vitest';
import { invitationIn, makeInvitation, redeemInvitation } from '../src/link/invitation';
import { parseControl } from '../src/wire/control';

const TOKEN = 'kerf_0123456789ab_0123456789abcdef0123456789abcdef';

function answer(status: number, body: unknown) {
  const respond = vi.fn<typeof fetch>(() =>
    Promise.resolve(new Response(JSON.stringify(body), { status })),
  );
  vi.stubGlobal('fetch', respond);
  return respond;
}

afterEach(() => vi.unstubAllGlobals());

describe('an invitation', () => {
  it('is taken from the fragment of an address only', () => {
    expect(invitationIn(`#invite=${TOKEN}`)).toBe(TOKEN);
    for (const other of ['', '#', '#invite=', '#invite=abc', `#token=${TOKEN}`, `#x${TOKEN}`]) {
      expect(invitationIn(other)).toBeNull();
    }
  });

  it('is exchanged with the token in a header and never in the address', async () => {
    const respond = answer(201, { role: 'sculptor' });
    expect(await redeemInvitation('demo', TOKEN, 'Ada & Co')).toBeNull();
    const [address, options] = respond.mock.calls[0]!;
    expect(address).toBe('/v1/sessions/demo/join?name=Ada%20%26%20Co');
    expect(options?.headers).toEqual({ authorization: `Bearer ${TOKEN}` });
  });

  it('that does not work says why', async () => {
    answer(401, { error: { code: 'bad_token', reason: 'it was revoked' } });
    expect(await redeemInvitation('demo', TOKEN, 'Ada')).toBe('it was revoked');
    vi.stubGlobal('fetch', () => Promise.reject(new Error('offline')));
    expect(await redeemInvitation('demo', TOKEN, 'Ada')).toBe('The server did not answer.');
  });

  it('is made as a complete link', async () => {
    const location = { origin: 'https://kerf.example', pathname: '/', search: '?session=demo' };
    vi.stubGlobal('location', location);
    const respond = answer(201, { link: `/?session=demo#invite=${TOKEN}` });
    expect(await makeInvitation('demo', 'watcher', 24)).toBe(
      `https://kerf.example/?session=demo#invite=${TOKEN}`,
    );
    expect(respond.mock.calls[0]![0]).toBe('/v1/sessions/demo/invitations?role=watcher&hours=24');
    answer(403, { error: { reason: 'a sculptor may not invite' } });
    await expect(makeInvitation('demo', 'owner', 24)).rejects.toThrow('a sculptor may not invite');
  });
});

describe('roles in messages', () => {
  const person = { participant: 3, name: 'Ada', color: '#d9541e', kind: 'agent' };
  const parse = (more: object) =>
    parseControl(JSON.stringify({ type: 'participants', participants: [{ ...person, ...more }] }));

  it('are read where the server states them', () => {
    expect(parse({ role: 'sculptor', muted: true })).toMatchObject({
      ok: true,
      value: { participants: [{ role: 'sculptor', muted: true }] },
    });
    const plain = parse({});
    expect(plain.ok && JSON.stringify(plain.value)).not.toMatch(/role|muted/);
    expect(parse({ role: 7 }).ok).toBe(false);
  });
});
