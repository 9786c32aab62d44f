// SPDX-License-Identifier: Apache-2.0
// Decodes binary frames (server/wire/README.md): the mirror of server/wire/decode.cpp. Decodes all
// types, also those that a viewer never receives, because both codecs must pass the same golden
// bytes. Bytes from a peer never cause an exception: every failure is a DecodeError.

import { checksum, MESH_SUMMED, SUMMED_HEADER_BYTES } from './checksum';
import { Reader } from './cursor';
import {
  AXIS_LENGTH_TOLERANCE,
  CONTACT_PLANE_BYTES,
  CONTACT_PLANES_MAX,
  DURABLE_HEADER_BYTES,
  FrameType,
  HEADER_BYTES,
  HEADER_BYTES_MAX,
  INTENT_BYTES,
  INTENTS_MAX,
  LIST_HEAD_BYTES,
  MAGIC,
  RESULT_BYTES,
  SAMPLE_BYTES,
  SAMPLES_PER_MESSAGE_MAX,
  STATES_DURABLE,
  STOCK_RESET,
  STOCK_RETURNED,
  STOCK_HEAD_BYTES,
  STOCK_TILE_BYTES,
  STOCK_TILES_MAX,
  TOOL_STATE_BYTES,
  TOOL_STATES_MAX,
} from './types';
import type {
  ContactPlane,
  Decoded,
  DecodeError,
  Frame,
  Header,
  Intent,
  Payload,
  Sample,
  StockTile,
  ToolState,
} from './types';

interface Failure {
  ok: false;
  error: DecodeError;
}

function reject(code: DecodeError['code'], offset: number, reason: string): Failure {
  return { ok: false, error: { code, offset, reason } };
}

function readSample(from: Reader): Sample {
  const sample = {
    agent_sequence: from.u64(),
    time_us: from.u64(),
    tip_mm: from.vec3d(),
    axis: from.vec3f(),
    tool_id: from.u32(),
    buttons: from.u32(),
    felt_share: from.f32(),
  };
  return sample;
}

function readToolState(from: Reader): ToolState {
  const state = {
    participant: from.u32(),
    tool_id: from.u32(),
    tip_mm: from.vec3d(),
    axis: from.vec3f(),
    status: from.u32(),
    force_n: from.vec3f(),
    torque_nmm: from.vec3f(),
    removed_rate_mm3_per_s: from.f32(),
    felt_share: from.f32(),
  };
  return state;
}

function readPlane(from: Reader): ContactPlane {
  const plane = {
    point_mm: from.vec3d(),
    normal: from.vec3f(),
    depth_mm: from.f32(),
    stiffness_n_per_mm: from.f32(),
    radius_mm: from.f32(),
    flags: from.u32(),
  };
  from.u32(); // reserved
  return plane;
}

function readResult(from: Reader, bytes: number): Decoded<Payload> {
  if (bytes < RESULT_BYTES)
    return reject('payload_mismatch', 8, `${bytes} payload bytes end inside the result`);
  const start = from.at;
  const head = {
    agent_sequence: from.u64(),
    agent_time_us: from.u64(),
    motions_applied: from.u64(),
    force_n: from.vec3f(),
    torque_nmm: from.vec3f(),
    engaged_area_mm2: from.f32(),
    direction: from.vec3f(),
    cut_centre_mm: from.vec3d(),
    specific_force_n_per_mm2: from.f32(),
    removed_mm3: from.f32(),
    status: from.u32(),
  };
  const count = from.u32();
  if (count > CONTACT_PLANES_MAX)
    return reject(
      'bad_count',
      start + 100,
      `${count} planes exceed the limit of ${CONTACT_PLANES_MAX}`,
    );
  if (bytes !== RESULT_BYTES + count * CONTACT_PLANE_BYTES) {
    return reject('payload_mismatch', 8, `${count} planes do not fill ${bytes} bytes`);
  }
  const tail = { collision_force_n: from.vec3f(), turnaround_us: from.u32() };
  const planes = Array.from({ length: count }, () => readPlane(from));
  return (
    notFinite(from) ?? { ok: true, value: { kind: 'result', result: { ...head, ...tail, planes } } }
  );
}

/**
 * Reads the count of a list and checks it against its limits and the number of bytes that follow.
 */
function readCount(
  from: Reader,
  bytes: number,
  least: number,
  most: number,
  entryBytes: number,
): Decoded<number> {
  const start = from.at;
  if (bytes < LIST_HEAD_BYTES)
    return reject('too_short', start, 'the payload ends before its count');
  const count = from.u32();
  from.u32(); // reserved
  if (count < least || count > most)
    return reject('bad_count', start, `count ${count} is not in ${least}..${most}`);
  if (bytes !== LIST_HEAD_BYTES + count * entryBytes) {
    return reject('payload_mismatch', start, `${count} entries do not fill ${bytes} bytes`);
  }
  return { ok: true, value: count };
}

function notFinite(from: Reader): Failure | null {
  return from.notFiniteAt < 0
    ? null
    : reject('not_finite', from.notFiniteAt, 'a number is not finite');
}

function readMotion(from: Reader, bytes: number): Decoded<Payload> {
  const count = readCount(from, bytes, 1, SAMPLES_PER_MESSAGE_MAX, SAMPLE_BYTES);
  if (!count.ok) return count;
  const samples: Sample[] = [];
  for (let i = 0; i < count.value; ++i) {
    const start = from.at;
    const sample = readSample(from);
    const failure = notFinite(from);
    if (failure) return failure;
    if (Math.abs(Math.hypot(...sample.axis) - 1) > AXIS_LENGTH_TOLERANCE) {
      return reject('axis_not_unit', start + 40, 'the axis is not a unit vector');
    }
    const follows = i === 0 || sample.agent_sequence === samples[i - 1]!.agent_sequence + 1n;
    if (sample.agent_sequence === 0n || !follows) {
      return reject('bad_sequence', start, 'sample numbers must be consecutive and start above 0');
    }
    samples.push(sample);
  }
  return { ok: true, value: { kind: 'motion', samples } };
}

function readTools(from: Reader, bytes: number): Decoded<Payload> {
  const count = readCount(from, bytes, 0, TOOL_STATES_MAX, TOOL_STATE_BYTES);
  if (!count.ok) return count;
  const tools: ToolState[] = [];
  for (let i = 0; i < count.value; ++i) tools.push(readToolState(from));
  return notFinite(from) ?? { ok: true, value: { kind: 'tools', tools } };
}

function readIntents(from: Reader, bytes: number): Decoded<Payload> {
  const count = readCount(from, bytes, 0, INTENTS_MAX, INTENT_BYTES);
  if (!count.ok) return count;
  const intents: Intent[] = [];
  for (let i = 0; i < count.value; ++i) {
    const start = from.at;
    const intent = {
      participant: from.u32(),
      tool_id: from.u32(),
      time_us: from.u64(),
      agent_time_us: from.u64(),
      tip_mm: from.vec3d(),
      axis: from.vec3f(),
      status: from.u32(),
    };
    const failure = notFinite(from);
    if (failure) return failure;
    if (Math.abs(Math.hypot(...intent.axis) - 1) > AXIS_LENGTH_TOLERANCE) {
      return reject('axis_not_unit', start + 48, 'the axis is not a unit vector');
    }
    intents.push(intent);
  }
  return { ok: true, value: { kind: 'intent', intents } };
}

function readStock(from: Reader, bytes: number, flags: number): Decoded<Payload> {
  const start = from.at;
  const end = start + bytes;
  if (bytes < STOCK_HEAD_BYTES)
    return reject('too_short', start, 'the payload ends before its count');
  const agent_time_us = from.u64();
  const count = from.u32();
  from.u32(); // reserved
  if (count > STOCK_TILES_MAX || count * STOCK_TILE_BYTES > end - from.at) {
    return reject('bad_count', start + 8, `${count} tiles exceed the limit or the payload`);
  }
  const tiles: StockTile[] = [];
  for (let i = 0; i < count; ++i) {
    const at = from.at;
    if (end - at < STOCK_TILE_BYTES)
      return reject('payload_mismatch', at, 'the payload ends inside a tile');
    const tile = { axis: from.u32(), x: from.u32(), y: from.u32() };
    const columnBytes = from.u32();
    if (tile.axis > 2) return reject('bad_count', at, `axis ${tile.axis} is not in 0..2`);
    if (columnBytes > end - from.at)
      return reject('payload_mismatch', at, 'the payload ends inside a tile');
    tiles.push({ ...tile, columns: from.bytes(columnBytes) });
  }
  if (from.at !== end) return reject('payload_mismatch', from.at, 'bytes follow the last tile');
  return {
    ok: true,
    value: {
      kind: 'stock',
      reset: (flags & STOCK_RESET) !== 0,
      returned: (flags & STOCK_RETURNED) !== 0,
      agent_time_us,
      tiles,
    },
  };
}

const FIXED_BYTES = new Map<number, number>([
  [FrameType.Ack, 0],
  [FrameType.Ping, 8],
  [FrameType.Pong, 16],
]);

function readPayload(
  view: DataView,
  type: number,
  flags: number,
  at: number,
  bytes: number,
): Decoded<Payload> {
  const fixed = FIXED_BYTES.get(type);
  if (fixed !== undefined && fixed !== bytes) {
    return reject('payload_mismatch', 8, `type ${type} needs ${fixed} payload bytes, not ${bytes}`);
  }
  const from = new Reader(view, at);
  switch (type) {
    case FrameType.Motion:
      return readMotion(from, bytes);
    case FrameType.Tools:
      return readTools(from, bytes);
    case FrameType.Mesh:
      return {
        ok: true,
        value: { kind: 'mesh', glb: new Uint8Array(view.buffer, view.byteOffset + at, bytes) },
      };
    case FrameType.Result:
      return readResult(from, bytes);
    case FrameType.Stock:
      return readStock(from, bytes, flags);
    case FrameType.Intent:
      return readIntents(from, bytes);
    case FrameType.Ack:
      return { ok: true, value: { kind: 'ack' } };
    case FrameType.Ping:
      return { ok: true, value: { kind: 'ping', time_us: from.u64() } };
    case FrameType.Pong:
      return { ok: true, value: { kind: 'pong', ping_time_us: from.u64(), time_us: from.u64() } };
    default:
      return { ok: true, value: { kind: 'unknown' } };
  }
}

function durableOf(view: DataView, headerBytes: number): Pick<Header, 'durable_sequence'> {
  const type = view.getUint8(4);
  const isAnswer = type === FrameType.Result || type === FrameType.Pong;
  const isStated = (view.getUint8(5) & STATES_DURABLE) !== 0;
  if (!isAnswer || !isStated || headerBytes < DURABLE_HEADER_BYTES) return {};
  return { durable_sequence: view.getBigUint64(HEADER_BYTES, true) };
}

/** Whether a mesh frame has the checksum that its header states, if it states one. */
function hasItsChecksum(view: DataView, headerBytes: number): boolean {
  const isSummed = (view.getUint8(5) & MESH_SUMMED) !== 0;
  if (view.getUint8(4) !== FrameType.Mesh || !isSummed) return true;
  if (headerBytes < SUMMED_HEADER_BYTES) return false;
  const bytes = new Uint8Array(view.buffer, view.byteOffset, view.byteLength);
  const sum = checksum(bytes.subarray(0, HEADER_BYTES), checksum(bytes.subarray(headerBytes)));
  return sum === view.getUint32(HEADER_BYTES, true);
}

/**
 * Decodes one binary frame. Types unknown to this version are no error: they are returned as
 * `unknown`.
 */
export function decodeFrame(bytes: ArrayBuffer | Uint8Array): Decoded<Frame> {
  const view =
    bytes instanceof Uint8Array
      ? new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
      : new DataView(bytes);
  const size = view.byteLength;
  if (size < HEADER_BYTES) return reject('too_short', size, 'the frame ends inside its header');
  if (view.getUint32(0, true) !== MAGIC)
    return reject('bad_magic', 0, 'the frame does not start with KRF1');
  const headerBytes = view.getUint16(6, true);
  if (headerBytes < HEADER_BYTES || headerBytes > Math.min(HEADER_BYTES_MAX, size)) {
    return reject('bad_header_bytes', 6, `header_bytes is ${headerBytes}`);
  }
  const payloadBytes = view.getUint32(8, true);
  if (payloadBytes !== size - headerBytes) {
    return reject(
      'payload_mismatch',
      8,
      `payload_bytes is ${payloadBytes}, but ${size - headerBytes} follow`,
    );
  }
  if (!hasItsChecksum(view, headerBytes))
    return reject('bad_checksum', HEADER_BYTES, 'the checksum does not match');
  const header: Header = {
    type: view.getUint8(4),
    flags: view.getUint8(5),
    epoch: view.getUint32(12, true),
    sequence: view.getBigUint64(16, true),
    time_us: view.getBigUint64(24, true),
    ...durableOf(view, headerBytes),
  };
  const payload = readPayload(view, header.type, header.flags, headerBytes, payloadBytes);
  return payload.ok ? { ok: true, value: { header, ...payload.value } } : payload;
}
