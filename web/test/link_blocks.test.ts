// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it, vi } from 'vitest';
import { ViewLink } from '../src/link/view_link';
import type { Socket } from '../src/link/socket';
import { encodeFrame } from '../src/wire/encode';
import { FrameType } from '../src/wire/types';

const WELCOME = JSON.stringify({
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
  grid: { origin_mm: [0, 0, 0], columns: [1, 1], tile: 32 },
});

function meshFrame(sequence: bigint): ArrayBuffer {
  const header = { type: FrameType.Mesh, flags: 0, epoch: 1, sequence, time_us: 0n };
  return encodeFrame({ header, kind: 'mesh', glb: new Uint8Array(4) }).buffer;
}

/** A connection whose mesh frames are applied when `finish` is called. */
function join() {
  const sent: unknown[] = [];
  const socket: Socket = {
    binaryType: '',
    onopen: null,
    onmessage: null,
    onclose: null,
    onerror: null,
    send: (data) => sent.push(data),
    close: () => undefined,
  };
  const applied: bigint[] = [];
  let finish: () => void = () => undefined;
  const none = (): undefined => undefined;
  const link = new ViewLink(
    {
      url: 'ws://host/v1/sessions/demo/view',
      name: 'Tester',
      open: () => socket,
      probe: () => Promise.resolve({}),
      look: () => null,
      reloadAt: () => false,
      budget: 0,
      nowMs: () => 0,
    },
    {
      greeted: none,
      served: none,
      renamed: none,
      pinged: none,
      status: none,
      message: none,
      tools: none,
      late: none,
      pong: none,
      problem: none,
      mesh: async ({ sequence }) => {
        applied.push(sequence);
        await new Promise<void>((resolve) => (finish = resolve));
      },
    },
  );
  link.start();
  const receive = (data: unknown): void => socket.onmessage?.({ data });
  return { link, receive, applied, sent, finish: () => finish() };
}

describe('view link', () => {
  it('does not put frames of the block before a seek into the one after it', async () => {
    const { link, receive, applied, finish } = join();
    receive(WELCOME);
    for (const sequence of [1n, 2n]) receive(meshFrame(sequence));
    await vi.waitFor(() => expect(applied).toEqual([1n]));
    receive(WELCOME); // the past begins while frame 2 waits
    receive(meshFrame(3n));
    finish();
    await vi.waitFor(() => expect(applied).toEqual([1n, 3n]));
    link.stop();
  });

  it('asks for the past once it was welcomed', () => {
    const { link, receive, sent } = join();
    link.seek({ type: 'seek', at: 7 });
    expect(sent).toEqual([]);
    receive(WELCOME);
    link.seek({ type: 'seek', at: 7, rate: 4 });
    expect(sent.at(-1)).toBe('{"type":"seek","at":7,"rate":4}');
    link.stop();
  });
});
