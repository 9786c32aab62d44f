// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/platform/clock.h"

namespace kerf::net {

/// A message shared by several peers.
using SharedBytes = std::shared_ptr<const std::vector<std::byte>>;

/// One WebSocket frame to send to a peer: `bytes`, followed by `shared` if it is set.
struct OutFrame {
  enum class Kind : std::uint8_t {
    kResult,
    kFelt,
    kText,
    kPong,
    kStock,
    kIntent,
    kTools,
    kMesh,
    kState,
    kParticipants,
    kPrograms,
    kMatter,
    kCameras
  };
  Kind kind = Kind::kText;
  std::vector<std::byte> bytes = {};
  SharedBytes shared = nullptr;
  Clock::time_point arrived = {};  ///< of the motion that a result answers

  bool is_text() const {
    return kind == Kind::kText || kind == Kind::kState || kind == Kind::kParticipants ||
           kind == Kind::kPrograms || kind == Kind::kMatter || kind == Kind::kCameras;
  }
};

/// A text shared by several peers.
using SharedText = std::shared_ptr<const std::string>;

/// Moves `text`, a message that newer ones replace, into `out`. Returns false if it is empty.
inline bool take_text(std::string& text, OutFrame::Kind kind, OutFrame& out) {
  if (text.empty()) return false;
  const auto bytes = std::as_bytes(std::span(text));
  out = {.kind = kind, .bytes = {bytes.begin(), bytes.end()}};
  text.clear();
  return true;
}

/// The time as frames carry it: microseconds of the server's monotonic clock.
inline std::uint64_t to_us(Clock::time_point time) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
}

}  // namespace kerf::net
