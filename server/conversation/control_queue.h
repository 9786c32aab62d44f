// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <span>
#include <string_view>
#include <utility>

#include "server/conversation/out_frame.h"
#include "server/wire/codec.h"

namespace kerf::net {

/// Messages to a peer that must all arrive, in order: JSON texts and pongs. The queue is bounded.
class ControlQueue {
 public:
  static constexpr std::size_t kMax = 64;

  /// Returns false if the queue is full because the peer does not read.
  bool put_text(std::string_view text) {
    if (queue_.size() >= kMax) return false;
    const auto bytes = std::as_bytes(std::span(text));
    queue_.push_back({.kind = OutFrame::Kind::kText, .bytes = {bytes.begin(), bytes.end()}});
    return true;
  }

  /// Drops the pong if the queue is full, because a ping measures the response time.
  void put_pong(const wire::FrameStamp& stamp, const wire::Pong& pong) {
    if (queue_.size() >= kMax) return;
    OutFrame& frame = queue_.emplace_back(OutFrame{.kind = OutFrame::Kind::kPong});
    wire::append(frame.bytes, stamp, pong);
  }

  /// Moves the oldest message into `out`. Returns false if the queue is empty.
  bool take(OutFrame& out) {
    if (queue_.empty()) return false;
    out = std::move(queue_.front());
    queue_.pop_front();
    return true;
  }

 private:
  std::deque<OutFrame> queue_;
};

}  // namespace kerf::net
