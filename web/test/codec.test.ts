// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { decodeFrame } from '../src/wire/decode';
import { encodeFrame } from '../src/wire/encode';
import type { Frame } from '../src/wire/types';

const golden = new URL('../../tests/wire/golden/', import.meta.url);

interface Accepted {
  file: string;
  type: string;
  type_number: number;
  flags: number;
  header_bytes: number;
  epoch: number;
  sequence: number;
  time_us: number;
  durable_sequence?: number;
  body: Record<string, unknown>;
}
interface Rejected {
  file: string;
  code: string;
  offset: number;
}
const index = JSON.parse(readFileSync(new URL('golden.json', golden), 'utf8')) as {
  version: number;
  frames: Accepted[];
  refused: Rejected[];
};

function bytesOf(file: string): Uint8Array {
  return new Uint8Array(readFileSync(new URL(file, golden)));
}

/**
 * Converts a frame's payload to its form in golden.json: u64 as numbers, byte arrays as hexadecimal
 * digits.
 */
function bodyOf(frame: Frame): unknown {
  const { header: _header, kind: _kind, ...payload } = frame;
  const hex = (bytes: Uint8Array) => Buffer.from(bytes).toString('hex');
  if (frame.kind === 'mesh') return { glb_hex: hex(frame.glb) };
  if (frame.kind === 'stock') {
    const tiles = frame.tiles.map(({ columns, ...tile }) => ({
      ...tile,
      columns_hex: hex(columns),
    }));
    return {
      reset: frame.reset,
      returned: frame.returned,
      agent_time_us: Number(frame.agent_time_us),
      tiles,
    };
  }
  const plain = frame.kind === 'result' ? frame.result : payload;
  return JSON.parse(
    JSON.stringify(plain, (_key, value: unknown) =>
      typeof value === 'bigint' ? Number(value) : value,
    ),
  );
}

describe('codec', () => {
  it('supports the version of the golden frames', () => {
    expect(index.version).toBe(1);
    expect(index.frames.length).toBeGreaterThan(8);
    expect(index.refused.length).toBeGreaterThan(15);
  });

  it.each(index.frames)('decodes $file to its golden content', (expected) => {
    const decoded = decodeFrame(bytesOf(expected.file));
    if (!decoded.ok) throw new Error(decoded.error.reason);
    const { header, kind } = decoded.value;
    expect(kind).toBe(expected.type);
    expect(header).toEqual({
      type: expected.type_number,
      flags: expected.flags,
      epoch: expected.epoch,
      sequence: BigInt(expected.sequence),
      time_us: BigInt(expected.time_us),
      ...(expected.durable_sequence === undefined
        ? {}
        : { durable_sequence: BigInt(expected.durable_sequence) }),
    });
    expect(bodyOf(decoded.value)).toEqual(expected.body);
  });

  const writable = index.frames.filter(
    (frame) => frame.header_bytes === 32 && frame.type !== 'unknown',
  );
  it.each(writable)('encodes $file to its golden bytes', ({ file }) => {
    const bytes = bytesOf(file);
    const decoded = decodeFrame(bytes);
    if (!decoded.ok) throw new Error(decoded.error.reason);
    expect(Buffer.from(encodeFrame(decoded.value)).equals(bytes)).toBe(true);
  });

  it.each(index.refused)('rejects $file with $code at byte $offset', ({ file, code, offset }) => {
    const decoded = decodeFrame(bytesOf(file));
    expect(decoded.ok).toBe(false);
    if (!decoded.ok)
      expect({ code: decoded.error.code, offset: decoded.error.offset }).toEqual({ code, offset });
  });

  it('rejects every proper prefix of every valid frame without throwing', () => {
    for (const { file } of index.frames) {
      const bytes = bytesOf(file);
      for (let size = 0; size < bytes.length; ++size)
        expect(decodeFrame(bytes.subarray(0, size)).ok).toBe(false);
    }
  });

  it('decodes a frame inside a larger buffer', () => {
    const bytes = bytesOf('tools_two.bin');
    const larger = new Uint8Array(bytes.length + 13);
    larger.set(bytes, 7);
    expect(decodeFrame(larger.subarray(7, 7 + bytes.length))).toEqual(decodeFrame(bytes));
  });
});
