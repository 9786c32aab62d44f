// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "server/wire/codec.h"

namespace kerf::net {

/// What waits to leave for one agent over its WebSocket. A wrench goes before all else, and a newer
/// one replaces one that has not left, since only the newest is worth feeling; the same goes for
/// what another participant feels; the block's columns go last. Buffers keep their memory.
class AgentOutbox {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Kind : std::uint8_t { kResult, kFelt, kText, kPong, kStock };
  struct Frame {
    Kind kind = Kind::kText;
    std::vector<std::byte> bytes;
    Clock::time_point arrived;  ///< of what a result answers
  };

  void put_result(const wire::FrameStamp& stamp, const wire::Result& result,
                  Clock::time_point arrived);
  void put_felt(const wire::FrameStamp& stamp, const wire::ToolState& felt);
  /// False if the agent reads so little that nothing more is kept for it.
  bool put_text(std::string_view text);
  /// Dropped where put_text would fail: a ping tells how long it takes to be answered.
  void put_pong(const wire::FrameStamp& stamp, const wire::Pong& pong);
  void put_stock(const wire::FrameStamp& stamp, const wire::StockPatch& patch);
  /// A stock frame has not left yet.
  bool has_stock() const { return stock_.has_value(); }

  /// Only texts and pongs that wait already leave from now on.
  void close();
  /// The next frame to leave, with its bytes; false if nothing waits.
  bool take(Frame& out);

 private:
  /// `slot`'s bytes if it holds any, else those of a frame that has left.
  template <class Body>
  void put(std::optional<Frame>& slot, Kind kind, const wire::FrameStamp& stamp, const Body& body);
  bool take_slot(std::optional<Frame>& slot, Frame& out);

  std::optional<Frame> result_, felt_, stock_;
  std::deque<Frame> control_;
  std::vector<std::byte> spare_;
  bool closed_ = false;
};

}  // namespace kerf::net
