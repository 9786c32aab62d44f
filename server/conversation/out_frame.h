// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace kerf::net {

using Clock = std::chrono::steady_clock;

/// A message that several peers share.
using SharedBytes = std::shared_ptr<const std::vector<std::byte>>;

/// One WebSocket frame to send to a peer: `bytes`, followed by `shared` if it is set.
struct OutFrame {
  enum class Kind : std::uint8_t { kResult, kFelt, kText, kPong, kStock, kTools, kMesh, kState };
  Kind kind = Kind::kText;
  std::vector<std::byte> bytes = {};
  SharedBytes shared = nullptr;
  Clock::time_point arrived = {};  ///< of the motion that a result answers

  bool is_text() const { return kind == Kind::kText || kind == Kind::kState; }
};

/// The time as frames carry it: microseconds of the server's monotonic clock.
inline std::uint64_t to_us(Clock::time_point time) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
}

}  // namespace kerf::net
