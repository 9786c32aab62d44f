// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import WebSocket from 'ws';
import { Backoff } from '../src/link/backoff';
import { EarlySocket } from '../src/link/early_socket';
import { helloText } from '../src/link/hello';
import { redirectTarget } from '../src/link/redirect';
import { ViewLink } from '../src/link/view_link';
import type { LinkOptions } from '../src/link/view_link';
import type { LinkStatus } from '../src/model/link_status';
import type { Socket } from '../src/link/socket';
import { VIEW_PROTOCOL } from '../src/wire/types';
import { SessionModel } from '../src/model/session';
import { FakeServer } from './support/fake_server.mjs';
import { turn } from './support/turn';

const CAMERA = { eye_mm: [0, -50, 90] as [number, number, number], error_rad: 0.001 };

function openSocket(url: string, protocol: string): Socket {
  return new WebSocket(url, protocol) as unknown as Socket;
}

type JoinOptions = Partial<LinkOptions> & { firstRetryMs?: number };

/** Connects to the fake server; events update a model, mesh frames count as applied. */
function join(port: number, session: string, { firstRetryMs = 5, ...others }: JoinOptions = {}) {
  const model = new SessionModel();
  const statuses: LinkStatus[] = [];
  const reasons: string[] = [];
  const applied: bigint[] = [];
  const names: string[] = [];
  const servers: string[] = [];
  const link = new ViewLink(
    {
      url: `ws://127.0.0.1:${port}/v1/sessions/${session}/view`,
      name: 'Tester',
      open: openSocket,
      probe: () => Promise.resolve({}),
      look: () => (model.welcome ? CAMERA : null),
      needsTiles: () => Promise.resolve(),
      reloadAt: () => false,
      budget: 0,
      nowMs: () => performance.now(),
      backoff: new Backoff(firstRetryMs, 4 * firstRetryMs),
      ...others,
    },
    {
      greeted: () => undefined,
      served: (origin) => servers.push(origin),
      renamed: (accepted) => names.push(accepted),
      pinged: () => undefined,
      late: () => undefined,
      status: (status, reason) => {
        statuses.push(status);
        reasons.push(reason);
        model.setStatus(status, reason);
      },
      message: (message) => model.apply(message),
      tools: (header, tools) => model.applyTools(header, tools, performance.now()),
      mesh: async (header) => {
        await Promise.resolve();
        applied.push(header.sequence);
      },
      pong: (sent, received, serverUs) => model.clock.pong(sent, received, serverUs),
      problem: (reason) => model.addProblem(reason),
    },
  );
  link.start();
  return { link, model, statuses, reasons, applied, names, servers };
}

describe('view link', () => {
  let server: FakeServer;
  beforeEach(async () => {
    server = new FakeServer({ pitchMm: 2 });
    await server.listen();
  });
  afterEach(() => server.close());

  const soon = (check: () => void): Promise<void> =>
    vi.waitFor(check, { timeout: 10_000, interval: 5 });
  /** Waits until a link has been connected `count` times. */
  const connected = (statuses: LinkStatus[], count: number): Promise<void> =>
    soon(() => expect(statuses.filter((status) => status === 'connected')).toHaveLength(count));

  /** A greeted connection, with a record of its events. */
  async function greeted() {
    const url = `ws://127.0.0.1:${server.port}/v1/sessions/demo/view`;
    const socket = openSocket(url, VIEW_PROTOCOL);
    const early = new EarlySocket(socket, helloText('Early', null, 0));
    const come = { messages: 0, isClosed: false };
    const { onmessage, onclose } = socket;
    socket.onmessage = (event) => {
      come.messages += 1;
      onmessage?.(event);
    };
    socket.onclose = (event) => {
      come.isClosed = true;
      onclose?.(event);
    };
    await soon(() => expect(server.hellos).toEqual(['Early']));
    return { early, come };
  }

  it('joins, receives participants and tools, and measures the round trip', async () => {
    const { link, model } = join(server.port, 'demo');
    await soon(() => expect(model.participants.get(1)?.forces.count).toBeGreaterThan(2));
    expect(model.status).toBe('connected');
    expect(server.hellos).toEqual(['Tester']);
    link.sendLook({ eye_mm: [1, 2, 300], error_rad: 0.0005 });
    await soon(() =>
      expect(server.lookMessages).toEqual([
        { type: 'look', eye_mm: [1, 2, 300], error_rad: 0.0005 },
      ]),
    );
    expect(model.participants.carvers().map((p) => p.info.name)).toEqual(['Ada', 'Linus']);
    await soon(() => expect(model.clock.rttMs).toBeGreaterThan(0));
    link.stop();
  });

  it('takes a connection that was greeted before it was there, and all that has come', async () => {
    const { early, come } = await greeted();
    await soon(() => expect(come.messages).toBeGreaterThan(3));
    const { link, model, applied, statuses } = join(server.port, 'demo', {
      name: 'Early',
      open: () => early.take(),
    });
    await soon(() => expect(server.acks.length).toBeGreaterThan(4));
    expect(server.hellos).toEqual(['Early']);
    expect(statuses).toEqual(['connecting', 'connected']);
    expect(model.participants.carvers()).toHaveLength(2);
    expect(applied).toEqual([...applied].sort((a, b) => Number(a - b)));
    link.stop();
  });

  it('joins once more by itself when the greeted connection is lost before it is taken', async () => {
    const { early, come } = await greeted();
    server.dropViewers();
    await soon(() => expect(come.isClosed).toBe(true));
    let opened = 0;
    const { link, model } = join(server.port, 'demo', {
      name: 'Early',
      open: (to, protocol) => (opened++ === 0 ? early.take() : openSocket(to, protocol)),
    });
    await soon(() => expect(model.state).not.toBeNull());
    expect(server.hellos).toEqual(['Early', 'Early']);
    link.stop();
  });

  it('acknowledges each mesh frame in order after it was applied', async () => {
    const { link, applied } = join(server.port, 'demo');
    await soon(() => expect(server.acks.length).toBeGreaterThan(4));
    link.stop();
    expect(server.acks).toEqual(applied.slice(0, server.acks.length));
  });

  it('applies mesh frames at once, and acknowledges them when more are of use', async () => {
    let needsMore = (): void => undefined;
    const needed = new Promise<void>((resolve) => (needsMore = resolve));
    const { link, applied } = join(server.port, 'demo', { needsTiles: () => needed });
    await soon(() => expect(applied.length).toBeGreaterThan(0));
    link.sendLook({ eye_mm: [1, 2, 300], error_rad: 0.0005 }); // comes after the earlier frames
    await soon(() => expect(server.lookMessages).toHaveLength(1));
    expect(server.acks).toEqual([]);
    needsMore();
    await soon(() => expect(server.acks.length).toBeGreaterThan(0));
    link.stop();
    expect(server.acks).toEqual(applied.slice(0, server.acks.length));
  });

  it('reconnects after a connection loss and receives a complete snapshot again', async () => {
    const { link, model, statuses } = join(server.port, 'demo');
    await soon(() => expect(model.state).not.toBeNull());
    server.dropViewers();
    await connected(statuses, 2);
    expect(server.hellos).toHaveLength(2);
    // The first look follows the welcome, which has the size of the block.
    expect(server.firstLooks).toEqual([true, CAMERA]);
    expect(model.tiles.complete).toBe(false);
    await soon(() => expect(model.state).not.toBeNull());
    link.stop();
    expect(statuses).toEqual(
      expect.arrayContaining(['connecting', 'connected', 'reconnecting', 'stopped']),
    );
  });

  it('knows the name under which it joins, which may be too long', () => {
    const { link } = join(server.port, 'demo', { name: 'x'.repeat(70) });
    expect(link.name).toBe('x'.repeat(64));
    link.rename('Ada');
    expect(link.name).toBe('Ada');
    link.stop();
  });

  it('joins again under another name, and keeps it', async () => {
    const { link, statuses } = join(server.port, 'demo');
    await connected(statuses, 1);
    link.rename('Grace');
    await connected(statuses, 2);
    server.dropViewers();
    await connected(statuses, 3);
    expect(server.hellos).toEqual(['Tester', 'Grace', 'Grace']);
    link.stop();
  });

  it('cuts names to the limit of the server', async () => {
    const long = 'ü'.repeat(40);
    const { link, statuses, names } = join(server.port, 'demo', { name: long });
    await connected(statuses, 1);
    link.rename('木'.repeat(40));
    await connected(statuses, 2);
    link.stop();
    expect(server.hellos).toEqual(['ü'.repeat(32), '木'.repeat(21)]);
    expect(names).toEqual(['木'.repeat(21)]);
  });

  it('reports a new name once the server has welcomed the viewer under it', async () => {
    const { link, model, names, reasons } = join(server.port, 'demo');
    await soon(() => expect(model.status).toBe('connected'));
    server.refusedName = 'Grace';
    link.rename('Grace');
    await soon(() => expect(reasons).toContain('name must be at most 64 bytes'));
    expect(names).toEqual([]);
    server.refusedName = null;
    await soon(() => expect(model.status).toBe('connected'));
    expect(names).toEqual(['Grace']);
    link.stop();
  });

  it('says when it tries again, and tries at once when asked', async () => {
    const { link, model, statuses } = join(server.port, 'demo', { firstRetryMs: 60_000 });
    await soon(() => expect(model.status).toBe('connected'));
    expect(link.retryAtMs).toBeNull();
    server.dropViewers();
    await soon(() => expect(link.retryAtMs).not.toBeNull());
    expect(link.retryAtMs! - performance.now()).toBeGreaterThan(30_000);
    link.retryNow();
    expect(link.retryAtMs).toBeNull();
    await connected(statuses, 2);
    link.stop();
  });

  it('stops with the reason if the session does not exist', async () => {
    const { model } = join(server.port, 'nowhere', {
      probe: () => Promise.resolve({ final: 'There is no session “nowhere” on this server.' }),
    });
    await soon(() => expect(model.status).toBe('stopped'));
    expect(model.statusReason).toContain('nowhere');
  });

  it('stops when the server reports an unknown session', async () => {
    const { model } = join(server.port, 'demo');
    await soon(() => expect(model.status).toBe('connected'));
    const text = JSON.stringify({
      type: 'error',
      code: 'unknown_session',
      reason: 'The session was closed.',
      fatal: true,
    });
    for (const { ws } of server.viewers) ws.send(text);
    await soon(() => expect(model.status).toBe('stopped'));
    expect(model.statusReason).toBe('The session was closed.');
  });

  it('reconnects after a temporary fatal error', async () => {
    const { link, model, statuses } = join(server.port, 'demo');
    await soon(() => expect(model.status).toBe('connected'));
    const text = JSON.stringify({
      type: 'error',
      code: 'no_hello',
      reason: 'no hello within 5 s',
      fatal: true,
    });
    for (const { ws } of server.viewers) ws.send(text);
    await connected(statuses, 2);
    link.stop();
  });

  it('reports the reason of a bye message', async () => {
    const { link, model, reasons } = join(server.port, 'demo');
    await soon(() => expect(model.status).toBe('connected'));
    for (const { ws } of server.viewers) {
      ws.send(JSON.stringify({ type: 'bye', reason: 'The server is going down.' }));
      ws.close(1001);
    }
    await soon(() => expect(reasons).toContain('The server is going down.'));
    link.stop();
  });

  it('stays where a redirect may not be followed', () => {
    const page = 'https://kerf.example/?session=demo&quality=1#invite=secret';
    const target = (redirect: string): string | null => redirectTarget(page, redirect);
    expect(target('https://next.example:8443')).toBe(
      'https://next.example:8443/?session=demo&quality=1',
    );
    for (const unsafe of [
      'http://next.example', // from TLS to plain HTTP
      'javascript:alert(1)',
      'https://user:secret@next.example',
      'https://next.example/elsewhere',
      'https://kerf.example', // here
      'next.example',
      '',
    ]) {
      expect(target(unsafe), unsafe).toBeNull();
    }
    expect(redirectTarget('http://a:1/?list', 'http://a:2')).toBe('http://a:2/?list');
  });

  it('reports invalid messages and stays connected', async () => {
    const { link, model } = join(server.port, 'demo');
    await soon(() => expect(model.status).toBe('connected'));
    for (const { ws } of server.viewers) {
      ws.send(new Uint8Array([1, 2, 3]));
      ws.send('{"type":"welcome"}');
      ws.send('not json');
    }
    await soon(() => expect(model.problems).toBe(3));
    const motions = model.state?.motions ?? 0;
    await soon(() => expect(model.state?.motions ?? 0).toBeGreaterThan(motions));
    expect(model.status).toBe('connected');
    link.stop();
  });

  it('does not reconnect after stop', async () => {
    const { link, model } = join(server.port, 'demo');
    await soon(() => expect(model.status).toBe('connected'));
    link.stop('Enough.');
    await soon(() => expect(server.viewers.size).toBe(0));
    await turn();
    expect(link.retryAtMs).toBeNull();
    expect(model.status).toBe('stopped');
    expect(server.hellos).toHaveLength(1);
  });
});
