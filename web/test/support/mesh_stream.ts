// SPDX-License-Identifier: Apache-2.0
// Half an hour of frames that a server has sent to a page that verifies
// (tests/server/write_mesh_stream), and a server of it, by a simulated clock: it keeps to the
// credit of two mesh frames and answers pings.

import { readFileSync } from 'node:fs';
import type { Socket } from '../../src/link/socket';
import { decodeFrame } from '../../src/wire/decode';
import { encodeFrame } from '../../src/wire/encode';
import { FrameType, STATES_DURABLE } from '../../src/wire/types';

export interface StreamPart {
  kind: 'mesh' | 'state' | 'digests';
  ms: number;
  bytes: Uint8Array<ArrayBuffer>;
}

const KINDS = ['mesh', 'state', 'digests'] as const;

export function readMeshStream(): StreamPart[] {
  const file = new Uint8Array(readFileSync(new URL('mesh_stream.bin', import.meta.url)));
  const numbers = new DataView(file.buffer);
  const parts: StreamPart[] = [];
  for (let at = 0; at < file.length;) {
    const [kind, ms, size] = [0, 4, 8].map((off) => numbers.getUint32(at + off, true));
    parts.push({ kind: KINDS[kind!]!, ms: ms!, bytes: file.slice(at + 12, at + 12 + size!) });
    at += 12 + size!;
  }
  return parts;
}

/** Digests by tile, `x y`. */
export function digestsIn({ bytes }: StreamPart): Map<string, string> {
  const lines = new TextDecoder().decode(bytes).trim().split('\n');
  return new Map(lines.map((line) => [line.slice(0, -17), line.slice(-16)]));
}

const WELCOME = {
  type: 'welcome',
  session: 'demo',
  participant: 1,
  epoch: 2,
  color: '#d9541e',
  pitch_mm: 0.625,
  pivot_mm: 60,
  stock: { shape: 'box', min_mm: [0, 0, 0], max_mm: [40, 30, 8] },
  tools: [],
  participants: [],
  meshes: 0,
  grid: { origin_mm: [0, 0, 0], columns: [64, 48], tile: 32 },
};

/** A pong whose header says which mesh frame was the last before it. */
function pongOf(pingUs: bigint, nowMs: number, mesh: bigint): Uint8Array<ArrayBuffer> {
  const time_us = BigInt(Math.round(1000 * nowMs));
  const pong = encodeFrame({
    header: { type: FrameType.Pong, flags: STATES_DURABLE, epoch: 2, sequence: 1n, time_us },
    kind: 'pong',
    ping_time_us: pingUs,
    time_us,
  });
  const longer = new Uint8Array(pong.length + 8);
  longer.set(pong.subarray(0, 32));
  longer.set(pong.subarray(32), 40);
  const numbers = new DataView(longer.buffer);
  numbers.setUint16(6, 40, true);
  numbers.setBigUint64(32, mesh, true);
  return longer;
}

export type Deliver = (data: ArrayBuffer | string, kind: StreamPart['kind'] | 'other') => void;

/** The server's side of one connection. */
export class StreamServer implements Socket {
  binaryType = 'arraybuffer';
  onopen: Socket['onopen'] = null;
  onmessage: Socket['onmessage'] = null;
  onclose: Socket['onclose'] = null;
  onerror: Socket['onerror'] = null;
  private next_ = 0;
  private sent_ = 0n;
  private acked_ = 0n;
  private isOpen_ = false;

  constructor(
    private readonly parts: readonly StreamPart[],
    private readonly nowMs: () => number,
    /** Takes the server's messages, and passes them on to the page (arrive). */
    private readonly relay: Deliver,
  ) {}

  open(): void {
    this.isOpen_ = true;
    this.onopen?.({} as never);
    this.relay(JSON.stringify(WELCOME), 'other');
    this.serve();
  }

  /** Something has come to the page. */
  arrive(data: ArrayBuffer | string): void {
    if (this.isOpen_) this.onmessage?.({ data });
  }

  /** Sends the frames that are due. */
  serve(): void {
    while (this.isOpen_) {
      const part = this.parts[this.next_];
      if (!part || part.ms > this.nowMs()) return;
      if (part.kind === 'mesh' && this.sent_ - this.acked_ >= 2n) return;
      this.next_ += 1;
      if (part.kind === 'mesh') {
        this.sent_ += 1n;
        this.relay(part.bytes.slice().buffer, 'mesh');
      } else if (part.kind === 'state') {
        this.relay(new TextDecoder().decode(part.bytes), 'state');
      }
    }
  }

  send(data: string | Uint8Array<ArrayBuffer>): void {
    if (typeof data === 'string') return;
    const frame = decodeFrame(data);
    if (!frame.ok) throw new Error(frame.error.reason);
    const { header, ...message } = frame.value;
    if (message.kind === 'ping')
      this.relay(pongOf(message.time_us, this.nowMs(), this.sent_).buffer, 'other');
    if (message.kind === 'ack') {
      this.acked_ = header.sequence;
      this.serve();
    }
  }

  close(): void {
    this.isOpen_ = false;
  }
}
