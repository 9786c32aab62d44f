// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Servers } from '../src/link/servers';

const AT = '/v1/sessions/s/agent';
const HOME = `ws://host${AT}`;

/** Where connections go that are never accepted. */
function turns(servers: Servers, count: number): string[] {
  return Array.from({ length: count }, () => {
    const { host } = new URL(servers.url);
    expect(servers.lost('', false)).toBe(false);
    return host;
  });
}

describe('the servers of a session', () => {
  it('are at first the one of the page', () => {
    expect(turns(new Servers(HOME), 3)).toEqual(['host', 'host', 'host']);
  });

  it('are tried by turns: the named one, then that which had named it', () => {
    const servers = new Servers(HOME);
    expect(servers.lost('http://owner:81', false)).toBe(true);
    expect(servers.url).toBe(`ws://owner:81${AT}`);
    expect(turns(servers, 3)).toEqual(['owner:81', 'host', 'owner:81']);
    servers.welcomed(['http://owner:81']);
    expect(servers.url).toBe(HOME);
    turns(servers, 1);
    servers.lost('http://heir:82', false);
    expect(servers.url).toBe(`ws://heir:82${AT}`);
  });

  it('are those that the welcome names, after the one that has accepted', () => {
    const servers = new Servers(HOME);
    servers.lost('http://owner:81', false);
    servers.welcomed(['http://heir:82', 'nowhere']);
    expect(servers.lost('', true)).toBe(false);
    expect(turns(servers, 4)).toEqual(['owner:81', 'heir:82', 'host', 'owner:81']);
  });

  it('are asked without a pause once, until one accepts', () => {
    const servers = new Servers(HOME);
    expect(servers.lost('http://owner:81', false)).toBe(true);
    expect(servers.lost('http://host', false)).toBe(false);
    expect(servers.url).toBe(HOME);
    servers.welcomed([]);
    expect(servers.lost('http://owner:81', true)).toBe(true);
  });

  it('are not followed to an address that is no server, to plain text, or to the same one', () => {
    const servers = new Servers(`wss://host${AT}`);
    for (const redirect of ['https://owner/elsewhere', 'http://owner', 'https://host', 'owner'])
      expect(servers.lost(redirect, true)).toBe(false);
    expect(servers.url).toBe(`wss://host${AT}`);
    expect(servers.lost('https://owner:444', true)).toBe(true);
    expect(servers.url).toBe(`wss://owner:444${AT}`);
  });
});
