// SPDX-License-Identifier: Apache-2.0
#include <cassert>
#include <cstring>

#include "server/wire/checksum.h"
#include "server/wire/codec.h"
#include "server/wire/layout.h"

namespace kerf::wire {
namespace {

ByteWriter start_frame(const FrameStamp& stamp, MessageType type, std::uint8_t flags,
                       std::size_t frame_bytes, std::span<std::byte> out,
                       std::size_t header_bytes = kHeaderBytes) noexcept {
  assert(out.size() >= header_bytes && frame_bytes <= kMaxServerFrameBytes);
  const FrameHeader header{.type = type,
                           .flags = flags,
                           .header_bytes = static_cast<std::uint16_t>(header_bytes),
                           .payload_bytes = static_cast<std::uint32_t>(frame_bytes - header_bytes),
                           .stamp = stamp};
  ByteWriter to(out);
  to.field(kMagic);
  to.field(static_cast<std::uint8_t>(header.type));
  walk(to, header);
  return to;
}

constexpr std::size_t header_bytes(std::uint64_t durable_sequence) noexcept {
  return durable_sequence == 0 ? kHeaderBytes : kDurableHeaderBytes;
}

/// Starts a frame whose header states a durable sequence unless that is 0.
ByteWriter start_frame(const FrameStamp& stamp, MessageType type, std::size_t frame_bytes,
                       std::span<std::byte> out, std::uint64_t durable_sequence) noexcept {
  const std::uint8_t flags = durable_sequence == 0 ? 0 : kStatesDurable;
  ByteWriter to = start_frame(stamp, type, flags, frame_bytes, out, header_bytes(durable_sequence));
  if (durable_sequence != 0) to.field(durable_sequence);
  return to;
}

}  // namespace

std::size_t encoded_bytes(const MotionBatch& batch) noexcept {
  return kHeaderBytes + kListHeadBytes + batch.count * kSampleBytes;
}
std::size_t encoded_bytes(const Result& result) noexcept {
  return header_bytes(result.durable_sequence) + kResultBytes +
         result.plane_count * kContactPlaneBytes;
}
std::size_t encoded_bytes(const MeshView& mesh) noexcept { return kHeaderBytes + mesh.glb.size(); }
std::size_t encoded_bytes(const ToolStates& states) noexcept {
  return kHeaderBytes + kListHeadBytes + states.tools.size() * kToolStateBytes;
}
std::size_t encoded_bytes(const Ack&) noexcept { return kHeaderBytes; }
std::size_t encoded_bytes(const Ping&) noexcept { return kHeaderBytes + kPingBytes; }
std::size_t encoded_bytes(const Pong& pong) noexcept {
  return header_bytes(pong.durable_sequence) + kPongBytes;
}

std::size_t encoded_bytes(const StockPatch& patch) noexcept {
  std::size_t bytes = kHeaderBytes + kStockHeadBytes;
  for (const StockTile& tile : patch.tiles) bytes += kStockTileBytes + tile.columns.size();
  return bytes;
}

std::size_t encoded_bytes(const Intents& intents) noexcept {
  return kHeaderBytes + kListHeadBytes + intents.count * kIntentBytes;
}

std::size_t encode(const FrameStamp& stamp, const Intents& intents,
                   std::span<std::byte> out) noexcept {
  assert(intents.count <= kMaxIntents);
  ByteWriter to = start_frame(stamp, MessageType::kIntent, 0, encoded_bytes(intents), out);
  to.field(intents.count);
  to.reserved();
  for (const Intent& intent : intents.view()) walk(to, intent);
  return to.at();
}

std::size_t encode(const FrameStamp& stamp, const MotionBatch& batch,
                   std::span<std::byte> out) noexcept {
  assert(batch.count >= 1 && batch.count <= kMaxSamplesPerMotion);
  ByteWriter to = start_frame(stamp, MessageType::kMotion, 0, encoded_bytes(batch), out);
  to.field(batch.count);
  to.reserved();
  for (const MotionSample& sample : batch.view()) walk(to, sample);
  return to.at();
}

std::size_t encode(const FrameStamp& stamp, const Result& result,
                   std::span<std::byte> out) noexcept {
  assert(result.plane_count <= kMaxContactPlanes);
  ByteWriter to =
      start_frame(stamp, MessageType::kResult, encoded_bytes(result), out, result.durable_sequence);
  walk(to, result);
  for (const ContactPlane& plane : result.contact()) walk(to, plane);
  return to.at();
}

std::size_t encode(const FrameStamp& stamp, const MeshView& mesh, std::uint8_t flags,
                   std::span<std::byte> out) noexcept {
  const std::size_t bytes = encoded_bytes(mesh);
  start_frame(stamp, MessageType::kMesh, flags, bytes, out);
  if (!mesh.glb.empty()) {
    std::memcpy(out.data() + kHeaderBytes, mesh.glb.data(), mesh.glb.size());
  }
  return bytes;
}

std::array<std::byte, kHeaderBytes> mesh_header(const FrameStamp& stamp, std::uint8_t flags,
                                                std::size_t glb_bytes) noexcept {
  std::array<std::byte, kHeaderBytes> header{};
  start_frame(stamp, MessageType::kMesh, flags, kHeaderBytes + glb_bytes, header);
  return header;
}

std::array<std::byte, kSummedHeaderBytes> summed_mesh_header(const FrameStamp& stamp,
                                                             std::uint8_t flags,
                                                             std::size_t glb_bytes,
                                                             std::uint32_t glb_sum) noexcept {
  std::array<std::byte, kSummedHeaderBytes> header{};
  ByteWriter to = start_frame(stamp, MessageType::kMesh, flags | kMeshSummed,
                              kSummedHeaderBytes + glb_bytes, header, kSummedHeaderBytes);
  to.field(checksum(std::span(header).first(kHeaderBytes), glb_sum));
  to.reserved();
  return header;
}

std::size_t encode(const FrameStamp& stamp, const ToolStates& states,
                   std::span<std::byte> out) noexcept {
  assert(states.tools.size() <= kMaxToolStates);
  ByteWriter to = start_frame(stamp, MessageType::kTools, 0, encoded_bytes(states), out);
  to.field(static_cast<std::uint32_t>(states.tools.size()));
  to.reserved();
  for (const ToolState& state : states.tools) walk(to, state);
  return to.at();
}

std::size_t encode(const FrameStamp& stamp, const Ack& ack, std::span<std::byte> out) noexcept {
  return start_frame(stamp, MessageType::kAck, 0, encoded_bytes(ack), out).at();
}

std::size_t encode(const FrameStamp& stamp, const Ping& ping, std::span<std::byte> out) noexcept {
  ByteWriter to = start_frame(stamp, MessageType::kPing, 0, encoded_bytes(ping), out);
  to.field(ping.time_us);
  return to.at();
}

std::size_t encode(const FrameStamp& stamp, const Pong& pong, std::span<std::byte> out) noexcept {
  ByteWriter to =
      start_frame(stamp, MessageType::kPong, encoded_bytes(pong), out, pong.durable_sequence);
  to.field(pong.ping_time_us);
  to.field(pong.time_us);
  return to.at();
}

std::size_t encode(const FrameStamp& stamp, const StockPatch& patch,
                   std::span<std::byte> out) noexcept {
  assert(patch.tiles.size() <= kMaxStockTiles);
  const int flags = (patch.reset ? kStockReset : 0) | (patch.returned ? kStockReturned : 0);
  ByteWriter to = start_frame(stamp, MessageType::kStock, static_cast<std::uint8_t>(flags),
                              encoded_bytes(patch), out);
  to.field(patch.agent_time_us);
  to.field(static_cast<std::uint32_t>(patch.tiles.size()));
  to.reserved();
  for (const StockTile& tile : patch.tiles) {
    to.field(tile.axis);
    to.field(tile.x);
    to.field(tile.y);
    to.field(static_cast<std::uint32_t>(tile.columns.size()));
    to.bytes(tile.columns);
  }
  return to.at();
}

}  // namespace kerf::wire
