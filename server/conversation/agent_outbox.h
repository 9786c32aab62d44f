// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/conversation/control_queue.h"
#include "server/platform/clock.h"

namespace kerf::net {

/// Outgoing frames for one agent over its WebSocket, in order of priority: the result, the tools
/// near the agent's, the force of the participant that it feels (`feel_of`), control messages, the
/// list of participants, stock. A newer result, force or list replaces one that has not left,
/// because only the newest is of use. Buffers are reused.
class AgentOutbox {
 public:
  void put_result(const wire::FrameStamp& stamp, const wire::Result& result,
                  Clock::time_point arrived);
  void put_intents(const wire::FrameStamp& stamp, const wire::Intents& intents);
  void put_felt(const wire::FrameStamp& stamp, const wire::ToolState& felt);
  /// Returns false if the agent reads so little that the control queue is full.
  bool put_text(std::string_view text);
  void put_pong(const wire::FrameStamp& stamp, const wire::Pong& pong);
  void put_participants(std::string text) {
    if (!closed_) participants_ = std::move(text);
  }
  void put_stock(const wire::FrameStamp& stamp, const wire::StockPatch& patch);
  /// Whether a stock frame waits to leave.
  bool has_stock() const { return stock_.has_value(); }

  /// Discards everything except control messages, and ignores later additions.
  void close();
  /// Moves the next frame into `out`, with its bytes. Returns false if the outbox is empty.
  bool take(OutFrame& out);

 private:
  /// Encodes into the slot's own buffer, or into the buffer of a frame that has left.
  template <class Body>
  void put(std::optional<OutFrame>& slot, OutFrame::Kind kind, const wire::FrameStamp& stamp,
           const Body& body);
  bool take_slot(std::optional<OutFrame>& slot, OutFrame& out);

  std::optional<OutFrame> result_, intents_, felt_, stock_;
  ControlQueue control_;
  std::string participants_;
  std::vector<std::byte> spare_;
  bool closed_ = false;
};

}  // namespace kerf::net
