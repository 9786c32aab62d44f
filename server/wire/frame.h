// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "server/wire/limits.h"

namespace kerf::wire {

/// The bytes `KRF1`. The last digit is the major version of the protocol.
inline constexpr std::uint32_t kMagic = 0x3146524B;

/// Types of binary messages. A reader skips unknown types.
enum class MessageType : std::uint8_t {
  kMotion = 1,
  kResult = 2,
  kMesh = 3,
  kTools = 4,
  kAck = 5,
  kPing = 6,
  kPong = 7,
  kStock = 8,
  kIntent = 9,
};

/// Flags of a mesh frame: part of the first snapshot; last part of it.
inline constexpr std::uint8_t kMeshSnapshot = 1;
inline constexpr std::uint8_t kMeshSnapshotEnd = 2;
/// Flag of a mesh frame: its header is kSummedHeaderBytes long and ends with a checksum.
inline constexpr std::uint8_t kMeshSummed = 4;

/// Flags of a stock frame: StockPatch::reset, StockPatch::returned.
inline constexpr std::uint8_t kStockReset = 1;
inline constexpr std::uint8_t kStockReturned = 2;

/// Flag of a result or a pong: its header is kDurableHeaderBytes long and ends with the durable
/// sequence of the agent.
inline constexpr std::uint8_t kStatesDurable = 1;

/// The header fields that the sender sets for each frame. The encoder fills in the rest.
struct FrameStamp {
  /// Grows when the server reopens a session.
  std::uint32_t epoch = 0;
  /// Per sender and message type, from 1. In an ack: that of the last mesh or stock frame applied.
  std::uint64_t sequence = 0;
  /// The sender's monotonic clock.
  std::uint64_t time_us = 0;
};

/// The header of a received frame. `type` may have a value that MessageType does not name.
struct FrameHeader {
  MessageType type = MessageType::kPing;
  std::uint8_t flags = 0;
  std::uint16_t header_bytes = kHeaderBytes;
  std::uint32_t payload_bytes = 0;
  FrameStamp stamp;
};

}  // namespace kerf::wire
