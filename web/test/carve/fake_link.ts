// SPDX-License-Identifier: Apache-2.0
// A connection of an agent and a copy of the block, for tests of CarveLink.

import { expect } from 'vitest';
import type { Draft } from '../../src/carve/sample_log';
import type { Socket } from '../../src/link/socket';
import { decodeFrame } from '../../src/wire/decode';
import { FrameType } from '../../src/wire/types';

export class FakeSocket implements Socket {
  binaryType = '';
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;
  onclose: ((event: { code: number; reason: string }) => void) | null = null;
  onerror: (() => void) | null = null;
  closed = false;
  readonly texts: Record<string, unknown>[] = [];
  readonly frames: Uint8Array[] = [];

  constructor(
    readonly url: string,
    readonly protocol: string,
  ) {}
  send(data: string | Uint8Array<ArrayBuffer>): void {
    if (typeof data === 'string') this.texts.push(JSON.parse(data) as Record<string, unknown>);
    else this.frames.push(data);
  }
  close(): void {
    this.closed = true;
  }
  say(message: object): void {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
  /** The numbers of the samples in each motion frame. */
  get motions(): number[][] {
    return this.frames.flatMap((bytes) => {
      const frame = decodeFrame(bytes);
      if (!frame.ok || frame.value.kind !== 'motion') return [];
      expect(frame.value.header).toMatchObject({ epoch: 5, type: FrameType.Motion });
      return [frame.value.samples.map(({ agent_sequence }) => Number(agent_sequence))];
    });
  }
}

/** Records the calls of a copy of the block. */
export class FakeCopy {
  works = false;
  readonly heard: string[] = [];
  open(welcome: string): void {
    this.heard.push(`open ${(JSON.parse(welcome) as { participant: number }).participant}`);
  }
  tools(message: string): void {
    this.heard.push(`tools ${(JSON.parse(message) as { tools: unknown[] }).tools.length}`);
  }
  cut(frame: Uint8Array, newest: bigint): void {
    const decoded = decodeFrame(frame);
    if (decoded.ok && decoded.value.kind === 'motion')
      this.heard.push(`cut ${decoded.value.samples.length} to ${newest}`);
  }
  take(frame: Uint8Array): void {
    const decoded = decodeFrame(frame);
    this.heard.push(`take ${decoded.ok ? decoded.value.kind : 'nothing'}`);
  }
  change(undone: boolean): void {
    this.heard.push(undone ? 'undo' : 'redo');
  }
  settle(): void {
    this.heard.push('settle');
  }
}

export const WELCOME = {
  type: 'welcome',
  participant: 3,
  epoch: 5,
  color: '#d9541e',
  limits: { samples_per_message: 16, samples_per_s: 1250, speed_mm_per_s: 500, frame_bytes: 4096 },
  resume: { token: 'ab12', resumed: false, agent_sequence: 0 },
};

export function drafts(count: number): Draft[] {
  return Array.from({ length: count }, (_, n) => ({
    time_us: BigInt(n + 1),
    tip_mm: [n, 0, 0],
    axis: [0, 0, 1],
    tool_id: 1,
    buttons: 1,
    felt_share: 0,
  }));
}
