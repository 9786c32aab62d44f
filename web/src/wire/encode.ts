// SPDX-License-Identifier: Apache-2.0
// Encodes binary frames (server/wire/README.md): the mirror of server/wire/encode.cpp.

import { Writer } from './cursor';
import {
  CONTACT_PLANE_BYTES,
  HEADER_BYTES,
  INTENT_BYTES,
  LIST_HEAD_BYTES,
  MAGIC,
  RESULT_BYTES,
  SAMPLE_BYTES,
  STOCK_HEAD_BYTES,
  STOCK_TILE_BYTES,
  TOOL_STATE_BYTES,
} from './types';
import type {
  ContactPlane,
  Frame,
  Intent,
  Payload,
  Result,
  Sample,
  StockTile,
  ToolState,
} from './types';

function writeSample(to: Writer, s: Sample): void {
  to.u64(s.agent_sequence);
  to.u64(s.time_us);
  to.vec3d(s.tip_mm);
  to.vec3f(s.axis);
  to.u32(s.tool_id);
  to.u32(s.buttons);
  to.f32(s.felt_share);
}

function writeToolState(to: Writer, t: ToolState): void {
  to.u32(t.participant);
  to.u32(t.tool_id);
  to.vec3d(t.tip_mm);
  to.vec3f(t.axis);
  to.u32(t.status);
  to.vec3f(t.force_n);
  to.vec3f(t.torque_nmm);
  to.f32(t.removed_rate_mm3_per_s);
  to.f32(t.felt_share);
}

function writePlane(to: Writer, p: ContactPlane): void {
  to.vec3d(p.point_mm);
  to.vec3f(p.normal);
  to.f32(p.depth_mm);
  to.f32(p.stiffness_n_per_mm);
  to.f32(p.radius_mm);
  to.u32(p.flags);
  to.u32(0);
}

function writeResult(to: Writer, r: Result): void {
  to.u64(r.agent_sequence);
  to.u64(r.agent_time_us);
  to.u64(r.motions_applied);
  to.vec3f(r.force_n);
  to.vec3f(r.torque_nmm);
  to.f32(r.engaged_area_mm2);
  to.vec3f(r.direction);
  to.vec3d(r.cut_centre_mm);
  to.f32(r.specific_force_n_per_mm2);
  to.f32(r.removed_mm3);
  to.u32(r.status);
  to.u32(r.planes.length);
  to.vec3f(r.collision_force_n);
  to.u32(r.turnaround_us);
  for (const plane of r.planes) writePlane(to, plane);
}

function writeStockTile(to: Writer, tile: StockTile): void {
  to.u32(tile.axis);
  to.u32(tile.x);
  to.u32(tile.y);
  to.u32(tile.columns.byteLength);
  to.bytes(tile.columns);
}

function writeIntent(to: Writer, intent: Intent): void {
  to.u32(intent.participant);
  to.u32(intent.tool_id);
  to.u64(intent.time_us);
  to.u64(intent.agent_time_us);
  to.vec3d(intent.tip_mm);
  to.vec3f(intent.axis);
  to.u32(intent.status);
}

function payloadSize(frame: Payload): number {
  switch (frame.kind) {
    case 'motion':
      return LIST_HEAD_BYTES + frame.samples.length * SAMPLE_BYTES;
    case 'result':
      return RESULT_BYTES + frame.result.planes.length * CONTACT_PLANE_BYTES;
    case 'mesh':
      return frame.glb.byteLength;
    case 'tools':
      return LIST_HEAD_BYTES + frame.tools.length * TOOL_STATE_BYTES;
    case 'stock':
      return frame.tiles.reduce(
        (sum, tile) => sum + STOCK_TILE_BYTES + tile.columns.byteLength,
        STOCK_HEAD_BYTES,
      );
    case 'intent':
      return LIST_HEAD_BYTES + frame.intents.length * INTENT_BYTES;
    case 'ping':
      return 8;
    case 'pong':
      return 16;
    case 'ack':
    case 'unknown':
      return 0;
  }
}

function writeList<T>(
  to: Writer,
  entries: readonly T[],
  write: (to: Writer, entry: T) => void,
): void {
  to.u32(entries.length);
  to.u32(0);
  for (const entry of entries) write(to, entry);
}

function writePayload(to: Writer, bytes: Uint8Array, frame: Payload): void {
  switch (frame.kind) {
    case 'motion':
      writeList(to, frame.samples, writeSample);
      break;
    case 'result':
      writeResult(to, frame.result);
      break;
    case 'mesh':
      bytes.set(frame.glb, to.at);
      break;
    case 'tools':
      writeList(to, frame.tools, writeToolState);
      break;
    case 'stock':
      to.u64(frame.agent_time_us);
      writeList(to, frame.tiles, writeStockTile);
      break;
    case 'intent':
      writeList(to, frame.intents, writeIntent);
      break;
    case 'ping':
      to.u64(frame.time_us);
      break;
    case 'pong':
      to.u64(frame.ping_time_us);
      to.u64(frame.time_us);
      break;
    case 'ack':
    case 'unknown':
      break;
  }
}

/** Encodes one frame. The header's type must match the payload; lengths are computed. */
export function encodeFrame(frame: Frame): Uint8Array<ArrayBuffer> {
  const payloadBytes = payloadSize(frame);
  const bytes = new Uint8Array(HEADER_BYTES + payloadBytes);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, MAGIC, true);
  view.setUint8(4, frame.header.type);
  view.setUint8(5, frame.header.flags);
  view.setUint16(6, HEADER_BYTES, true);
  view.setUint32(8, payloadBytes, true);
  view.setUint32(12, frame.header.epoch, true);
  view.setBigUint64(16, frame.header.sequence, true);
  view.setBigUint64(24, frame.header.time_us, true);
  writePayload(new Writer(view, HEADER_BYTES), bytes, frame);
  return bytes;
}
