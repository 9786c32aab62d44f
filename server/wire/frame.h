// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "server/wire/limits.h"

namespace kerf::wire {

/// The bytes `KRF1`: the last one is the major version of the protocol.
inline constexpr std::uint32_t kMagic = 0x3146524B;

/// Binary message types. A reader skips a type that it does not know.
enum class MessageType : std::uint8_t {
  kMotion = 1,
  kResult = 2,
  kMesh = 3,
  kTools = 4,
  kAck = 5,
  kPing = 6,
  kPong = 7,
  kStock = 8,
};

/// Flags of a mesh frame: it belongs to the first snapshot; it is the snapshot's last part.
inline constexpr std::uint8_t kMeshSnapshot = 1;
inline constexpr std::uint8_t kMeshSnapshotEnd = 2;

/// Flag of a stock frame: StockPatch::reset.
inline constexpr std::uint8_t kStockReset = 1;

/// What a sender chooses for each frame; the encoder fills in the rest of the header.
struct FrameStamp {
  /// Grows when a session is taken over or rebuilt.
  std::uint32_t epoch = 0;
  /// Per sender and message type, from 1. In an ack: the last mesh frame that was applied.
  std::uint64_t sequence = 0;
  /// The sender's monotonic clock.
  std::uint64_t time_us = 0;
};

/// The header as it was received. `type` may hold a value that MessageType does not name.
struct FrameHeader {
  MessageType type = MessageType::kPing;
  std::uint8_t flags = 0;
  std::uint16_t header_bytes = kHeaderBytes;
  std::uint32_t payload_bytes = 0;
  FrameStamp stamp;
};

}  // namespace kerf::wire
