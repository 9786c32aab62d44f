// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { CarveLink } from '../../src/carve/carve_link';
import { Backoff } from '../../src/link/backoff';
import { decodeFrame } from '../../src/wire/decode';
import { encodeFrame } from '../../src/wire/encode';
import { FrameType } from '../../src/wire/types';

import { drafts, FakeCopy, FakeSocket, WELCOME } from './fake_link';

const golden = new URL('../../../tests/wire/golden/', import.meta.url);

describe('carve link', () => {
  let sockets: FakeSocket[];
  let log: string[];
  let link: CarveLink;
  let copy: FakeCopy;
  const failed = (): void => void log.push('failed');

  beforeEach(() => {
    vi.useFakeTimers();
    sockets = [];
    log = [];
    copy = new FakeCopy();
    link = new CarveLink(
      {
        url: 'ws://host/v1/sessions/s/agent',
        open: (url, protocol) => {
          sockets.push(new FakeSocket(url, protocol));
          return sockets.at(-1)!;
        },
        who: () => ({ name: 'Grace', color: '#d9541e', tool: 2 }),
        nowMs: () => Date.now(),
        copy,
        list: () => Promise.resolve([]),
        backoff: new Backoff(100, 100),
      },
      {
        status: (status, reason) => log.push(`${status} ${reason}`.trim()),
        joined: ({ speedMmPerS }) => log.push(`joined ${speedMmPerS}`),
        result: ({ agent_sequence }) => log.push(`result ${agent_sequence}`),
        rejected: (code, reason) => log.push(`rejected ${code} ${reason}`),
        changed: (undone) => log.push(undone ? 'undone' : 'redone'),
      },
    );
  });
  afterEach(() => {
    link.leave();
    vi.useRealTimers();
  });

  function join(): FakeSocket {
    link.join();
    sockets.at(-1)!.onopen?.();
    sockets.at(-1)!.say(WELCOME);
    return sockets.at(-1)!;
  }

  /** The golden result, with other numbers. */
  function answer(socket: FakeSocket, sequence: bigint, durable: bigint): void {
    const bytes = new Uint8Array(readFileSync(new URL('result_durable.bin', golden)));
    const view = new DataView(bytes.buffer);
    view.setBigUint64(32, durable, true);
    view.setBigUint64(40, sequence, true);
    socket.onmessage?.({ data: bytes.buffer });
  }

  it('gives the tools that are made to the copy', () => {
    copy.works = true;
    const socket = join();
    socket.say({ type: 'tools', tools: [{ id: 3 }, { id: 4 }] });
    expect(copy.heard.at(-1)).toBe('tools 2');
  });

  it('joins with name, color and tool, and sends its samples in messages of 16', () => {
    const socket = join();
    expect(socket.protocol).toBe('kerf.agent.v1');
    expect(socket.texts).toEqual([
      { type: 'hello', name: 'Grace', color: '#d9541e', tool: 2, durable: true },
    ]);
    expect(log).toEqual(['joining', 'ready', 'joined 500']);
    link.send(drafts(20));
    expect(socket.motions.map((numbers) => numbers.length)).toEqual([16, 4]);
    expect(socket.motions.flat()).toEqual(Array.from({ length: 20 }, (_, n) => n + 1));
  });

  it('continues as the participant of the page before, which was loaded again', () => {
    copy.works = true;
    const kept: string[] = [];
    const again = new CarveLink(
      {
        url: 'ws://host/v1/sessions/s/agent',
        open: (url, protocol) => {
          sockets.push(new FakeSocket(url, protocol));
          return sockets.at(-1)!;
        },
        who: () => ({ name: 'Ada', color: '#112233', tool: 1 }),
        nowMs: () => Date.now(),
        copy,
        list: () => Promise.resolve([]),
        token: 'ab12',
        keep: (token) => kept.push(token),
      },
      {
        status: () => undefined,
        joined: () => undefined,
        result: () => undefined,
        rejected: () => undefined,
        changed: () => undefined,
      },
    );
    again.join();
    const socket = sockets.at(-1)!;
    socket.onopen?.();
    expect(socket.texts[0]).toMatchObject({ resume: 'ab12' });
    socket.say({ ...WELCOME, resume: { token: 'ab12', resumed: true, agent_sequence: 7 } });
    expect(copy.heard).toEqual(['open 3']);
    again.send(drafts(2));
    expect(socket.motions).toEqual([[8, 9]]);
    expect(kept).toEqual(['ab12']);
    again.leave();
  });

  it('continues as the same participant, and resends samples that may be missing', () => {
    const first = join();
    link.send(drafts(5));
    first.onclose?.({ code: 1006, reason: '' });
    expect(log.at(-1)).toBe('lost The connection was lost.');
    vi.advanceTimersByTime(150);
    const second = sockets.at(-1)!;
    expect(second).not.toBe(first);
    second.onopen?.();
    expect(second.texts[0]).toMatchObject({ resume: 'ab12', durable: true });
    const resume = { token: 'ab12', resumed: true, agent_sequence: 3 };
    second.say({ ...WELCOME, resume });
    expect(second.motions).toEqual([[3, 4, 5]]);
    link.send(drafts(1));
    expect(second.motions.at(-1)).toEqual([6]);
    first.say({ type: 'bye', reason: 'too late' });
    expect(log.at(-1)).toBe('joined 500');
  });

  it('sends a long path again no faster than the server takes it', () => {
    const first = join();
    link.send(drafts(3000));
    first.onclose?.({ code: 1006, reason: '' });
    vi.advanceTimersByTime(150);
    const second = sockets.at(-1)!;
    second.onopen?.();
    second.say(WELCOME);
    expect(second.motions.flat()).toHaveLength(900);
    expect(link.takes).toBe(false);
    expect(link.waiting).toBe(2100);
    vi.advanceTimersByTime(1000);
    expect(second.motions.flat().length).toBeGreaterThan(900 + 1100);
    expect(second.motions.flat().length).toBeLessThanOrEqual(900 + 1250);
    vi.advanceTimersByTime(1000);
    expect(second.motions.flat()).toEqual(Array.from({ length: 3000 }, (_, n) => n + 1));
    expect(link.waiting).toBe(0);
  });

  it('starts again with the whole path if the connection breaks in the middle of it', () => {
    join();
    link.send(drafts(3000));
    for (let n = 0; n < 2; ++n) {
      sockets.at(-1)!.onclose?.({ code: 1006, reason: '' });
      vi.advanceTimersByTime(150);
      sockets.at(-1)!.onopen?.();
      sockets.at(-1)!.say(WELCOME);
    }
    vi.advanceTimersByTime(2000);
    expect(sockets).toHaveLength(3);
    expect(sockets[1]!.motions.flat()).toHaveLength(900);
    expect(sockets[2]!.motions.flat()).toHaveLength(3000);
  });

  it('drops durable samples, as results state them', () => {
    const socket = join();
    link.send(drafts(10));
    answer(socket, 9n, 7n);
    expect(log.at(-1)).toBe('result 9');
    socket.onclose?.({ code: 1006, reason: '' });
    vi.advanceTimersByTime(150);
    sockets.at(-1)!.onopen?.();
    sockets.at(-1)!.say(WELCOME); // of a server that has lost the rest
    expect(sockets.at(-1)!.motions).toEqual([[7, 8, 9, 10]]);
  });

  it('leaves and comes back with its token', () => {
    const first = join();
    link.leave();
    expect(first.closed).toBe(true);
    expect(log.at(-1)).toBe('off');
    link.send(drafts(1));
    expect(first.motions).toEqual([]);
    expect(join().texts[0]).toMatchObject({ resume: 'ab12' });
  });

  it('holds back while the server is half a second behind', () => {
    const socket = join();
    expect(link.takes).toBe(true);
    link.send(drafts(600));
    expect(link.takes).toBe(false);
    answer(socket, 300n, 1n);
    expect(link.takes).toBe(true);
    socket.onclose?.({ code: 1006, reason: '' });
    expect(link.takes).toBe(false);
  });

  it('reports rejections, undo and the reason of a bye', () => {
    const socket = join();
    link.change(true, 1, failed);
    expect(socket.texts.at(-1)).toEqual({ type: 'undo' });
    socket.say({ type: 'stroke', undone: true, stroke: 7, sequence: 9 });
    link.change(true, 1, failed);
    socket.say({ type: 'stroke', undone: true, code: 'bad_message', reason: 'no such stroke' });
    socket.say({ type: 'error', code: 'muted', reason: 'an owner has muted you', fatal: false });
    expect(log.slice(-4)).toEqual([
      'undone',
      'failed',
      'rejected bad_message no such stroke',
      'rejected muted an owner has muted you',
    ]);
    socket.say({ type: 'bye', reason: 'going down' });
    socket.onclose?.({ code: 1001, reason: '' });
    expect(log.at(-1)).toBe('lost going down');
  });

  it('tells the copy of an undo at once, and the server one at a time', () => {
    copy.works = true;
    const socket = join();
    for (const undone of [true, true, false]) link.change(undone, 1, failed);
    expect(copy.heard).toEqual(['open 3', 'undo', 'undo', 'redo']);
    const asked = (): unknown[] => socket.texts.slice(1).map(({ type }) => type);
    expect(asked()).toEqual(['undo']);
    expect([link.isAsking, link.takes, link.waiting]).toEqual([true, false, 2]);
    link.ask({ type: 'stock' });
    expect(asked()).toEqual(['undo', 'stock']);
    socket.say({ type: 'stroke', undone: true, stroke: 7, sequence: 9 });
    expect(asked()).toEqual(['undo', 'stock', 'undo']);
    socket.say({ type: 'stroke', undone: true, code: 'bad_message', reason: 'no such stroke' });
    expect(copy.heard.at(-1)).toBe('settle');
    expect(asked()).toEqual(['undo', 'stock', 'undo', 'redo']);
    expect([link.isAsking, link.takes]).toEqual([true, true]);
    socket.onclose?.({ code: 1006, reason: '' });
    expect([link.isAsking, link.waiting]).toEqual([false, 0]);
  });

  const AT = '/v1/sessions/s/agent';

  /** The server says that another one has the session, and closes. */
  function sendOn(socket: FakeSocket, redirect: string): void {
    socket.say({ type: 'bye', reason: 'it is elsewhere', redirect });
    socket.onclose?.({ code: 1000, reason: '' });
  }

  it('goes on at the server that has the session, as the same participant', () => {
    link.join();
    sendOn(sockets[0]!, 'http://owner:81');
    expect(sockets.map(({ url }) => url)).toEqual([`ws://host${AT}`, `ws://owner:81${AT}`]);
    expect(log).toEqual(['joining', 'joining']);
    sockets[1]!.onopen?.();
    sockets[1]!.say(WELCOME);
    link.send(drafts(5));
    sendOn(sockets[1]!, 'http://heir:82');
    expect(sockets[2]!.url).toBe(`ws://heir:82${AT}`);
    sockets[2]!.onopen?.();
    expect(sockets[2]!.texts[0]).toMatchObject({ resume: 'ab12' });
    const resume = { token: 'ab12', resumed: true, agent_sequence: 3 };
    sockets[2]!.say({ ...WELCOME, resume });
    expect(sockets[2]!.motions).toEqual([[3, 4, 5]]);
  });

  it('takes no redirect of an earlier connection', () => {
    link.join();
    sendOn(sockets[0]!, 'http://owner:81');
    sockets[1]!.onclose?.({ code: 1006, reason: '' });
    vi.advanceTimersByTime(150);
    expect(sockets[2]!.url).toBe(`ws://host${AT}`);
    expect(log.at(-1)).toBe('joining The connection was lost.');
  });

  it('does not come back after it was removed, and tries again when it was too early', () => {
    const socket = join();
    socket.say({ type: 'error', code: 'removed', reason: 'an owner', fatal: true });
    expect(log.at(-1)).toBe('off an owner');
    vi.advanceTimersByTime(10_000);
    expect(sockets).toHaveLength(1);
    const again = join();
    again.say({ type: 'error', code: 'busy', reason: 'full', fatal: true });
    expect(log.at(-1)).toBe('lost full');
    link.retryNow();
    expect(sockets).toHaveLength(3);
  });

  it('gives up a connection on which nothing comes', () => {
    const socket = join();
    vi.advanceTimersByTime(9000);
    expect(socket.frames.length).toBeGreaterThan(5); // pings
    expect(log.at(-1)).toBe('joined 500');
    vi.advanceTimersByTime(3000);
    expect(log).toContain('lost The server stopped answering.');
  });

  /** A stock frame without tiles. */
  function stock(socket: FakeSocket, flags: number, sequence: bigint): void {
    const header = { type: FrameType.Stock, flags, epoch: 5, sequence, time_us: 1n };
    const flagged = { reset: flags === 1, returned: false };
    const frame = encodeFrame({ header, kind: 'stock', ...flagged, agent_time_us: 0n, tiles: [] });
    socket.onmessage?.({ data: frame.buffer });
  }

  it('passes sent and received messages to the copy, once, and acknowledges stock', () => {
    copy.works = true;
    const first = join();
    expect(first.texts[0]).toMatchObject({ stock: true, whole: true, returned: true });
    link.send(drafts(20));
    stock(first, 1, 7n);
    answer(first, 9n, 7n);
    const joined = ['open 3', 'cut 16 to 16', 'cut 4 to 20', 'take stock', 'take result'];
    expect(copy.heard).toEqual(joined);
    const ack = decodeFrame(first.frames.at(-1)!);
    expect(ack.ok && ack.value.header).toMatchObject({ type: FrameType.Ack, sequence: 7n });
    first.onclose?.({ code: 1006, reason: '' });
    vi.advanceTimersByTime(150);
    const second = sockets.at(-1)!;
    second.onopen?.();
    second.say({ ...WELCOME, resume: { token: 'ab12', resumed: true, agent_sequence: 9 } });
    // Samples that are sent again have been cut. No more are cut until the server's stock has come.
    expect(copy.heard).toEqual(joined);
    expect(link.takes).toBe(false);
    stock(second, 0, 1n);
    expect(link.takes).toBe(false);
    stock(second, 1, 2n);
    expect(link.takes).toBe(true);
  });

  it('opens the copy again in a block that does not know it, and cuts its samples there', () => {
    copy.works = true;
    const first = join();
    link.send(drafts(3));
    first.onclose?.({ code: 1006, reason: '' });
    vi.advanceTimersByTime(150);
    sockets.at(-1)!.onopen?.();
    sockets.at(-1)!.say(WELCOME);
    expect(copy.heard).toEqual(['open 3', 'cut 3 to 3', 'open 3', 'cut 3 to 3']);
    expect(link.takes).toBe(true);
  });

  it('is not lost while the browser lets a hidden page run once a minute', () => {
    join();
    for (let minute = 0; minute < 5; ++minute) {
      vi.setSystemTime(Date.now() + 60_000);
      vi.advanceTimersByTime(1000);
    }
    expect(log.at(-1)).toBe('joined 500');
  });
});
