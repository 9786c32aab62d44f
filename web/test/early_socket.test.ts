// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { EarlySocket, joinEarly, openView } from '../src/link/early_socket';
import type { Socket } from '../src/link/socket';
import { VIEW_PROTOCOL } from '../src/wire/types';

const URL_OF_S = 'ws://host:1/v1/sessions/s/view';

/** A connection of the browser. */
class FakeWebSocket implements Socket {
  static all: FakeWebSocket[] = [];
  binaryType = 'blob';
  onopen: Socket['onopen'] = null;
  onmessage: Socket['onmessage'] = null;
  onclose: Socket['onclose'] = null;
  onerror: Socket['onerror'] = null;
  readonly sent: unknown[] = [];

  constructor(
    readonly url: string,
    readonly protocol: string,
  ) {
    FakeWebSocket.all.push(this);
  }

  send(data: unknown): void {
    this.sent.push(data);
  }

  close(): void {
    // Nothing is asked of it then.
  }
}

describe('the first connection of a page', () => {
  beforeEach(() => {
    FakeWebSocket.all = [];
    vi.stubGlobal('window', { addEventListener: vi.fn() });
    vi.stubGlobal('WebSocket', FakeWebSocket);
    vi.stubGlobal('localStorage', { getItem: () => 'Ada', setItem: () => undefined });
    vi.stubGlobal('navigator', {});
  });
  afterEach(() => vi.unstubAllGlobals());

  function at(search: string, hash = ''): void {
    vi.stubGlobal('location', { origin: 'http://host:1', search, hash });
  }

  it('is greeted before the page is there, and taken once', async () => {
    at('?session=s');
    joinEarly();
    const [socket] = FakeWebSocket.all;
    expect([socket!.url, socket!.protocol]).toEqual([URL_OF_S, VIEW_PROTOCOL]);
    expect(socket!.binaryType).toBe('arraybuffer');
    socket!.onopen?.({} as never);
    // No look yet: one follows the welcome.
    const hello = {
      type: 'hello',
      name: 'Ada',
      changes: true,
      repeat: true,
      verify: true,
      look: true,
    };
    expect(socket!.sent).toEqual([JSON.stringify(hello)]);
    socket!.onmessage?.({ data: 'welcome' });
    const taken = openView(URL_OF_S, VIEW_PROTOCOL);
    expect(taken).toBeInstanceOf(EarlySocket);
    const events: unknown[] = [];
    taken.onopen = () => events.push('open');
    taken.onmessage = ({ data }) => events.push(data);
    await Promise.resolve();
    socket!.onmessage?.({ data: 'state' });
    expect(events).toEqual(['open', 'welcome', 'state']);
    const next = openView(URL_OF_S, VIEW_PROTOCOL);
    expect(next).toBe(FakeWebSocket.all[1]);
  });

  it('is not that to another server', () => {
    at('?session=s');
    joinEarly();
    const other = openView('ws://heir:2/v1/sessions/s/view', VIEW_PROTOCOL);
    expect(other).toBe(FakeWebSocket.all[1]);
  });

  it('is not opened without a session, nor before an invitation is redeemed', () => {
    at('?list');
    joinEarly();
    at('?session=s', '#invite=kerf_1_2');
    joinEarly();
    expect(FakeWebSocket.all).toEqual([]);
  });
});
