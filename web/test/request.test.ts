// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { probeSession } from '../src/link/api';
import { socketUrl } from '../src/link/address';
import { isForbidden, watchPolicy } from '../src/link/forbidden';
import { makeInvitation } from '../src/link/invitation';
import { notLoaded, pageAddress, useServer } from '../src/link/request';
import { listStrokes } from '../src/link/strokes';
import { takeHome } from '../src/link/take_home';

const HOME = 'http://home:1';
const HEIR = 'http://heir:2';

type Answer = Response | Error;

/** Answers requests, by address and mode; lists them. */
function serve(answers: (address: string, init: RequestInit) => Answer): string[] {
  const asked: string[] = [];
  vi.stubGlobal('fetch', (address: string, init: RequestInit = {}) => {
    asked.push(`${init.mode ?? init.credentials} ${address}`);
    const answer = answers(address, init);
    return answer instanceof Error ? Promise.reject(answer) : Promise.resolve(answer);
  });
  return asked;
}

const json = (body: object, status = 200): Response =>
  new Response(JSON.stringify(body), { status });

describe('requests of the page', () => {
  beforeEach(() => {
    const location = {
      origin: HOME,
      href: `${HOME}/?session=s`,
      pathname: '/',
      search: '?session=s',
    };
    vi.stubGlobal('location', location);
    useServer(HOME);
  });
  afterEach(() => {
    useServer(HOME);
    vi.unstubAllGlobals();
  });

  it('go to the server of the page, then to the one that has let the viewer in', async () => {
    const asked = serve(() => json({ strokes: [], link: '/?session=s#invite=t' }));
    await listStrokes('s');
    expect(socketUrl('s', 'agent')).toBe('ws://home:1/v1/sessions/s/agent');
    useServer(HEIR);
    await listStrokes('s');
    expect(await makeInvitation('s', 'watcher', 1)).toBe(`${HEIR}/?session=s#invite=t`);
    await takeHome('s', 'model.stl', new AbortController().signal, () => undefined);
    expect(asked).toEqual([
      'include /v1/sessions/s/strokes?since=0',
      `include ${HEIR}/v1/sessions/s/strokes?since=0`,
      `include ${HEIR}/v1/sessions/s/invitations?role=watcher&hours=1`,
      `include ${HEIR}/v1/sessions/s/model.stl`,
    ]);
    expect(socketUrl('s', 'agent')).toBe('ws://heir:2/v1/sessions/s/agent');
    expect(socketUrl('a b', 'view')).toBe('ws://heir:2/v1/sessions/a%20b/view');
    expect(pageAddress()).toBe(`${HEIR}/?session=s`);
    expect(pageAddress('?list')).toBe(`${HEIR}/?list`);
    useServer(HOME);
    await listStrokes('s');
    expect(asked.at(-1)).toBe('include /v1/sessions/s/strokes?since=0');
  });

  it('say where they have failed', async () => {
    serve(() => new Error('refused'));
    await expect(listStrokes('s')).rejects.toThrow('The server did not answer.');
    expect(notLoaded()).not.toContain('Open the page');
    useServer(HEIR);
    const reason = `${HEIR} did not answer, or refuses pages from ${HOME}`;
    await expect(listStrokes('s')).rejects.toThrow(reason);
    expect(notLoaded()).toContain(`${HOME} does not answer. Open the page at ${HEIR}.`);
  });

  it('tell why a session cannot be joined', async () => {
    const asked = serve(() => json({}, 404));
    expect((await probeSession('a b', HEIR)).final).toContain('There is no session “a b”');
    expect(asked).toEqual([`include ${HEIR}/v1/sessions/a%20b`]);
    serve(() => json({}, 401));
    expect((await probeSession('s', HOME)).final).toContain('invitation');
    expect(await probeSession('s', HEIR)).toEqual({ isForItsPage: true }); // which may have a pass
    serve(() => json({}, 503));
    expect(await probeSession('s', HEIR)).toEqual({});
  });

  it('tell a server that is gone from one whose answers the browser hides', async () => {
    serve(() => new Error('gone'));
    expect(await probeSession('s', HOME)).toEqual({});
    expect(await probeSession('s', HEIR)).toEqual({ isForItsPage: false });
    serve((_, { mode }) => (mode === 'no-cors' ? json({}) : new Error('CORS')));
    expect(await probeSession('s', HEIR)).toEqual({ isForItsPage: true });
  });

  it('know which servers the policy of the page forbids', async () => {
    const page = new EventTarget();
    vi.stubGlobal('document', page);
    watchPolicy();
    const violates = (blockedURI: string): void => {
      page.dispatchEvent(Object.assign(new Event('securitypolicyviolation'), { blockedURI }));
    };
    violates('eval');
    violates('ws://later:3/v1/sessions/s/view');
    expect(isForbidden('http://later:3')).toBe(true);
    expect(isForbidden(HEIR)).toBe(false);
    serve(() => new Error('gone'));
    expect(await probeSession('s', 'http://later:3')).toEqual({ isForItsPage: true });
  });
});
