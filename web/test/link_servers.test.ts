// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Backoff } from '../src/link/backoff';
import type { Rejection } from '../src/link/api';
import { ViewLink } from '../src/link/view_link';
import type { LinkStatus } from '../src/model/link_status';
import type { Socket } from '../src/link/socket';
import { SessionModel } from '../src/model/session';

const PATH = '/v1/sessions/demo/view';

function welcomeOf(others: string[]): string {
  return JSON.stringify({
    type: 'welcome',
    session: 'demo',
    participant: 3,
    epoch: 1,
    color: '#d9541e',
    pitch_mm: 1,
    pivot_mm: 60,
    stock: { shape: 'box', min_mm: [0, 0, 0], max_mm: [1, 1, 1] },
    tools: [],
    participants: [],
    others,
    grid: { origin_mm: [0, 0, 0], columns: [1, 1], tile: 32 },
  });
}

const BYE = { type: 'bye', reason: 'The server stops.' };

class FakeSocket implements Socket {
  binaryType = '';
  onopen: Socket['onopen'] = null;
  onmessage: Socket['onmessage'] = null;
  onclose: Socket['onclose'] = null;
  onerror: Socket['onerror'] = null;
  readonly sent: string[] = [];

  constructor(readonly url: string) {}

  send(data: string | Uint8Array): void {
    if (typeof data === 'string') this.sent.push(data);
  }

  close(): void {
    // The link asks for nothing after it.
  }

  /** The server lets the viewer in. */
  welcome(others: string[] = []): void {
    this.onopen?.({} as never);
    this.onmessage?.({ data: welcomeOf(others) });
  }

  bye(redirect?: string): void {
    this.onmessage?.({ data: JSON.stringify({ ...BYE, redirect }) });
    this.lose();
  }

  lose(): void {
    this.onclose?.({ code: 1006, reason: '' });
  }
}

/** A viewer at http://home:1 whose connections the test answers. */
function join(rejections: Record<string, Rejection> = {}) {
  const sockets: FakeSocket[] = [];
  const served: string[] = [];
  const statuses: LinkStatus[] = [];
  const reloads: string[] = [];
  const model = new SessionModel();
  const none = (): undefined => undefined;
  const link = new ViewLink(
    {
      url: `ws://home:1${PATH}`,
      name: 'Tester',
      open: (url) => {
        sockets.push(new FakeSocket(url));
        return sockets.at(-1)!;
      },
      probe: (server) => Promise.resolve(rejections[server] ?? {}),
      look: () => (model.welcome ? { eye_mm: [0, -50, 90], error_rad: 0.001 } : null),
      budget: 0,
      reloadAt: (server) => reloads.push(server) > 0,
      nowMs: () => performance.now(),
      backoff: new Backoff(100, 100),
    },
    {
      greeted: none,
      served: (server) => served.push(server),
      renamed: none,
      pinged: none,
      status: (status) => statuses.push(status),
      message: (message) => model.apply(message),
      tools: none,
      late: none,
      mesh: () => Promise.resolve(),
      pong: none,
      problem: none,
    },
  );
  link.start();
  const socket = (): FakeSocket => sockets.at(-1)!;
  /** Connections that are not accepted. */
  const fail = async (count: number): Promise<string[]> => {
    const hosts: string[] = [];
    for (let n = 0; n < count; ++n) {
      hosts.push(new URL(socket().url).host);
      socket().lose();
      await vi.advanceTimersByTimeAsync(100);
    }
    return hosts;
  };
  return { link, model, sockets, socket, served, statuses, reloads, fail };
}

describe('a viewer of a session that several servers share', () => {
  beforeEach(() => vi.useFakeTimers());
  afterEach(() => vi.useRealTimers());

  it('goes at once to the server that a bye names, with the camera, and stays in the page', () => {
    const { link, model, sockets, socket, served, statuses, reloads } = join();
    socket().welcome();
    model.tiles.offer(0, 0, 7, 12);
    socket().bye('http://heir:2');
    expect(sockets.map(({ url }) => url)).toEqual([`ws://home:1${PATH}`, `ws://heir:2${PATH}`]);
    socket().welcome(['http://home:1']);
    expect(served).toEqual(['http://home:1', 'http://heir:2']);
    expect(statuses).toEqual(['connecting', 'connected', 'reconnecting', 'connected']);
    expect(JSON.parse(socket().sent[0]!)).toMatchObject({
      name: 'Tester',
      look: { eye_mm: [0, -50, 90] },
    });
    expect(model.tiles.size).toBe(1); // the picture stays until the tiles of the other one come
    expect(reloads).toEqual([]);
    link.stop();
  });

  it('is sent on before it is welcomed', () => {
    const { link, socket, served } = join();
    socket().bye('http://owner:2');
    expect(socket().url).toBe(`ws://owner:2${PATH}`);
    socket().welcome();
    expect(served).toEqual(['http://owner:2']);
    link.stop();
  });

  it('does not follow two servers that name each other without a pause', async () => {
    const { link, sockets, socket } = join();
    socket().bye('http://other:2');
    socket().bye('http://home:1');
    expect(sockets).toHaveLength(2);
    await vi.advanceTimersByTimeAsync(100);
    expect(sockets.map(({ url }) => new URL(url).host)).toEqual(['home:1', 'other:2', 'home:1']);
    link.stop();
  });

  it('tries the servers that the welcome has named by turns when its own is gone', async () => {
    const { link, socket, served, reloads, fail } = join();
    socket().welcome(['http://second:2', 'http://third:3']);
    socket().lose();
    await vi.advanceTimersByTimeAsync(100);
    expect(await fail(5)).toEqual(['home:1', 'second:2', 'third:3', 'home:1', 'second:2']);
    socket().welcome();
    expect(served.at(-1)).toBe('http://third:3');
    expect(reloads).toEqual([]);
    link.stop();
  });

  it('comes back to the server of its page when the other one is gone too', async () => {
    const { link, socket, served, fail } = join();
    socket().welcome();
    socket().bye('http://heir:2');
    socket().welcome();
    socket().lose();
    await vi.advanceTimersByTimeAsync(100);
    expect(await fail(1)).toEqual(['heir:2']);
    socket().welcome();
    expect(served.at(-1)).toBe('http://home:1');
    link.stop();
  });

  it('loads the page of a server that lets in no other, once nobody else has let it in', async () => {
    const { link, sockets, socket, reloads, fail } = join({
      'http://heir:2': { isForItsPage: true },
    });
    socket().welcome();
    socket().bye('http://heir:2');
    await fail(3);
    expect(reloads).toEqual([]);
    await fail(1);
    expect(reloads).toEqual(['http://heir:2']);
    await vi.advanceTimersByTimeAsync(10_000);
    expect(sockets).toHaveLength(5); // the page leaves: no more attempts
    link.stop();
  });

  it('forgets that a server did not let it in when another one has', async () => {
    const { link, socket, reloads, fail } = join({ 'http://heir:2': { isForItsPage: true } });
    socket().welcome();
    socket().bye('http://heir:2');
    await fail(2);
    expect(socket().url).toContain('heir:2');
    await fail(1);
    socket().welcome(); // its own is back
    socket().lose();
    await vi.advanceTimersByTimeAsync(100);
    await fail(6);
    expect(reloads).toEqual([]);
    link.stop();
  });

  it('counts the attempts since it was let in last', async () => {
    const { link, socket, reloads, fail } = join({ 'http://heir:2': { isForItsPage: true } });
    socket().welcome();
    socket().bye('http://heir:2');
    expect(await fail(3)).toEqual(['heir:2', 'home:1', 'heir:2']);
    socket().welcome();
    socket().bye('http://heir:2');
    await fail(3);
    expect(reloads).toEqual([]);
    link.stop();
  });

  it('stops where a server says that there is no such session', async () => {
    const { socket, statuses, fail } = join({ 'http://heir:2': { final: 'None.' } });
    socket().welcome();
    socket().bye('http://heir:2');
    await fail(1);
    expect(statuses.at(-1)).toBe('stopped');
  });
});
