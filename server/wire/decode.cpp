// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <utility>

#include "server/wire/checksum.h"
#include "server/wire/codec.h"
#include "server/wire/layout.h"

namespace kerf::wire {
namespace {

using Unexpected = std::unexpected<DecodeError>;

Unexpected reject(DecodeErrorCode code, std::size_t offset, std::string_view reason) noexcept {
  return Unexpected(DecodeError{code, offset, reason});
}

Unexpected reject_not_finite(std::size_t offset) noexcept {
  return reject(DecodeErrorCode::kNotFinite, offset, "a number is not finite (NaN or infinity)");
}

/// Decodes the count of a list and checks it against its limits and the payload size.
std::expected<std::uint32_t, DecodeError> decode_count(ByteReader& from, std::size_t payload_bytes,
                                                       std::uint32_t min, std::uint32_t max,
                                                       std::size_t entry_bytes) noexcept {
  const std::size_t start = from.at();
  if (payload_bytes < kListHeadBytes) {
    return reject(DecodeErrorCode::kTooShort, start, "the payload is too short for a count");
  }
  std::uint32_t count = 0;
  from.field(count);
  from.reserved();
  if (count < min || count > max) {
    return reject(DecodeErrorCode::kBadCount, start, "the count is out of range");
  }
  if (payload_bytes != kListHeadBytes + count * entry_bytes) {
    return reject(DecodeErrorCode::kPayloadMismatch, start, "the count does not match the payload");
  }
  return count;
}

std::expected<MotionBatch, DecodeError> decode_motion(ByteReader& from,
                                                      std::size_t payload_bytes) noexcept {
  const auto count = decode_count(from, payload_bytes, 1, kMaxSamplesPerMotion, kSampleBytes);
  if (!count) return std::unexpected(count.error());
  MotionBatch batch;
  batch.count = *count;
  constexpr std::size_t kAxisOffset = 40;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const std::size_t start = from.at();
    MotionSample& sample = batch.samples[i];
    walk(from, sample);
    if (from.not_finite_at() != 0) return reject_not_finite(from.not_finite_at());
    if (std::abs(length(Vec3(sample.axis)) - 1.0) > kAxisLengthTolerance) {
      return reject(DecodeErrorCode::kAxisNotUnit, start + kAxisOffset,
                    "the axis must have length 1");
    }
    const bool follows = i == 0 || sample.agent_sequence == batch.samples[i - 1].agent_sequence + 1;
    if (sample.agent_sequence == 0 || !follows) {
      return reject(DecodeErrorCode::kBadSequence, start,
                    "agent_sequence must be consecutive, from 1");
    }
  }
  return batch;
}

std::expected<ToolStates, DecodeError> decode_tools(ByteReader& from, std::size_t payload_bytes) {
  const auto count = decode_count(from, payload_bytes, 0, kMaxToolStates, kToolStateBytes);
  if (!count) return std::unexpected(count.error());
  ToolStates states;
  states.tools.resize(*count);
  for (ToolState& state : states.tools) walk(from, state);
  if (from.not_finite_at() != 0) return reject_not_finite(from.not_finite_at());
  return states;
}

std::expected<Intents, DecodeError> decode_intents(ByteReader& from,
                                                   std::size_t payload_bytes) noexcept {
  const auto count = decode_count(from, payload_bytes, 0, kMaxIntents, kIntentBytes);
  if (!count) return std::unexpected(count.error());
  constexpr std::size_t kAxisOffset = 48;
  Intents intents;
  intents.count = *count;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const std::size_t start = from.at();
    walk(from, intents.tools[i]);
    if (from.not_finite_at() != 0) return reject_not_finite(from.not_finite_at());
    if (std::abs(length(Vec3(intents.tools[i].axis)) - 1.0) > kAxisLengthTolerance) {
      return reject(DecodeErrorCode::kAxisNotUnit, start + kAxisOffset,
                    "the axis must have length 1");
    }
  }
  return intents;
}

std::expected<Result, DecodeError> decode_result(ByteReader& from,
                                                 std::size_t payload_bytes) noexcept {
  constexpr std::size_t kPlaneCountOffset = 100;
  const std::size_t start = from.at();
  Result result;
  if (payload_bytes < kResultBytes) {
    return reject(DecodeErrorCode::kPayloadMismatch, 8, "the payload is too short for a result");
  }
  walk(from, result);
  if (result.plane_count > kMaxContactPlanes) {
    return reject(DecodeErrorCode::kBadCount, start + kPlaneCountOffset,
                  "the count is out of range");
  }
  if (payload_bytes != kResultBytes + result.plane_count * kContactPlaneBytes) {
    return reject(DecodeErrorCode::kPayloadMismatch, 8, "the count does not match the payload");
  }
  for (std::uint32_t i = 0; i < result.plane_count; ++i) walk(from, result.planes[i]);
  if (from.not_finite_at() != 0) return reject_not_finite(from.not_finite_at());
  return result;
}

std::expected<StockPatch, DecodeError> decode_stock(ByteReader& from, std::size_t payload_bytes,
                                                    std::uint8_t flags) {
  const std::size_t start = from.at(), end = start + payload_bytes;
  if (payload_bytes < kStockHeadBytes) {
    return reject(DecodeErrorCode::kTooShort, start, "the payload is too short for a count");
  }
  StockPatch patch;
  patch.reset = (flags & kStockReset) != 0;
  patch.returned = (flags & kStockReturned) != 0;
  std::uint32_t count = 0;
  from.field(patch.agent_time_us);
  const std::size_t count_at = from.at();
  from.field(count);
  from.reserved();
  if (count > kMaxStockTiles || count * kStockTileBytes > end - from.at()) {
    return reject(DecodeErrorCode::kBadCount, count_at, "the count is out of range");
  }
  patch.tiles.resize(count);
  for (StockTile& tile : patch.tiles) {
    const std::size_t tile_at = from.at();
    std::uint32_t bytes = 0;
    if (end - tile_at < kStockTileBytes) {
      return reject(DecodeErrorCode::kPayloadMismatch, tile_at,
                    "the payload is too short for its tiles");
    }
    from.field(tile.axis);
    from.field(tile.x);
    from.field(tile.y);
    from.field(bytes);
    if (tile.axis > 2) {
      return reject(DecodeErrorCode::kBadCount, tile_at, "the axis of a tile must be 0, 1 or 2");
    }
    if (bytes > end - from.at()) {
      return reject(DecodeErrorCode::kPayloadMismatch, tile_at,
                    "the payload is too short for its tiles");
    }
    tile.columns = from.bytes(bytes);
  }
  if (from.at() != end) {
    return reject(DecodeErrorCode::kPayloadMismatch, from.at(),
                  "trailing bytes after the last tile");
  }
  return patch;
}

Ping decode_ping(ByteReader& from) noexcept {
  Ping ping;
  from.field(ping.time_us);
  return ping;
}

Pong decode_pong(ByteReader& from) noexcept {
  Pong pong;
  from.field(pong.ping_time_us);
  from.field(pong.time_us);
  return pong;
}

/// The durable sequence in the header of a result or a pong, or 0 if it states none.
std::uint64_t decode_durable(std::span<const std::byte> frame, const FrameHeader& header) noexcept {
  std::uint64_t durable = 0;
  if ((header.flags & kStatesDurable) == 0 || header.header_bytes < kDurableHeaderBytes) return 0;
  ByteReader from(frame, kHeaderBytes);
  from.field(durable);
  return durable;
}

/// Whether a mesh frame has the checksum that its header states, if it states one.
bool has_its_checksum(std::span<const std::byte> frame, const FrameHeader& header) noexcept {
  if ((header.flags & kMeshSummed) == 0) return true;
  if (header.header_bytes < kSummedHeaderBytes) return false;
  std::uint32_t stated = 0;
  ByteReader(frame, kHeaderBytes).field(stated);
  return stated ==
         checksum(frame.first(kHeaderBytes), checksum(frame.subspan(header.header_bytes)));
}

/// Returns the payload size of a type with a fixed one, or nullopt for lists, results, meshes and
/// unknown types.
std::optional<std::size_t> fixed_payload_bytes(MessageType type) noexcept {
  switch (type) {
    case MessageType::kAck:
      return 0;
    case MessageType::kPing:
      return kPingBytes;
    case MessageType::kPong:
      return kPongBytes;
    default:
      return std::nullopt;
  }
}

}  // namespace

ErrorCode protocol_error(DecodeErrorCode code) noexcept {
  switch (code) {
    case DecodeErrorCode::kTooLong:
      return ErrorCode::kTooLarge;
    case DecodeErrorCode::kBadSequence:
      return ErrorCode::kBadSequence;
    case DecodeErrorCode::kNotFinite:
    case DecodeErrorCode::kAxisNotUnit:
      return ErrorCode::kBadPose;
    default:
      return ErrorCode::kBadFrame;
  }
}

std::expected<FrameHeader, DecodeError> decode_header(std::span<const std::byte> frame,
                                                      std::size_t max_bytes) noexcept {
  if (frame.size() > max_bytes) {
    return reject(DecodeErrorCode::kTooLong, max_bytes, "the frame exceeds the size limit");
  }
  if (frame.size() < kHeaderBytes) {
    return reject(DecodeErrorCode::kTooShort, frame.size(),
                  "the frame is too short for its header");
  }
  ByteReader from(frame, 0);
  std::uint32_t magic = 0;
  std::uint8_t type = 0;
  FrameHeader header;
  from.field(magic);
  from.field(type);
  walk(from, header);
  header.type = static_cast<MessageType>(type);
  if (magic != kMagic) {
    return reject(DecodeErrorCode::kBadMagic, 0, "the frame does not start with KRF1");
  }
  if (header.header_bytes < kHeaderBytes || header.header_bytes > kMaxHeaderBytes ||
      header.header_bytes > frame.size()) {
    return reject(DecodeErrorCode::kBadHeaderBytes, 6, "header_bytes is out of range");
  }
  if (header.payload_bytes != frame.size() - header.header_bytes) {
    return reject(DecodeErrorCode::kPayloadMismatch, 8, "payload_bytes does not match the frame");
  }
  return header;
}

std::expected<Message, DecodeError> decode(std::span<const std::byte> frame,
                                           std::size_t max_bytes) {
  const auto header = decode_header(frame, max_bytes);
  if (!header) return std::unexpected(header.error());
  const auto fixed_bytes = fixed_payload_bytes(header->type);
  if (fixed_bytes && *fixed_bytes != header->payload_bytes) {
    return reject(DecodeErrorCode::kPayloadMismatch, 8,
                  "the payload has the wrong size for its type");
  }
  ByteReader from(frame, header->header_bytes);
  std::expected<Message, DecodeError> message(std::in_place, *header, UnknownBody{});
  const auto keep = [&](auto&& body) {
    if (body) {
      message->body = std::move(*body);
    } else {
      message = std::unexpected(body.error());
    }
  };
  switch (header->type) {
    case MessageType::kMotion:
      keep(decode_motion(from, header->payload_bytes));
      break;
    case MessageType::kResult:
      keep(decode_result(from, header->payload_bytes));
      if (auto* result = message ? std::get_if<Result>(&message->body) : nullptr) {
        result->durable_sequence = decode_durable(frame, *header);
      }
      break;
    case MessageType::kMesh:
      if (!has_its_checksum(frame, *header)) {
        return reject(DecodeErrorCode::kBadChecksum, kHeaderBytes, "the checksum does not match");
      }
      message->body = MeshView{frame.subspan(header->header_bytes)};
      break;
    case MessageType::kTools:
      keep(decode_tools(from, header->payload_bytes));
      break;
    case MessageType::kAck:
      message->body = Ack{};
      break;
    case MessageType::kPing:
      message->body = decode_ping(from);
      break;
    case MessageType::kPong:
      message->body = decode_pong(from);
      std::get<Pong>(message->body).durable_sequence = decode_durable(frame, *header);
      break;
    case MessageType::kStock:
      keep(decode_stock(from, header->payload_bytes, header->flags));
      break;
    case MessageType::kIntent:
      keep(decode_intents(from, header->payload_bytes));
      break;
  }
  return message;
}

}  // namespace kerf::wire
