// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/agent_outbox.h"

#include <algorithm>
#include <span>
#include <utility>

#include "server/conversation/control_queue.h"

namespace kerf::net {

template <class Body>
void AgentOutbox::put(std::optional<Frame>& slot, Kind kind, const wire::FrameStamp& stamp,
                      const Body& body) {
  if (closed_) return;
  if (!slot) slot.emplace(kind, std::exchange(spare_, {}));
  slot->bytes.clear();
  wire::append(slot->bytes, stamp, body);
}

void AgentOutbox::put_result(const wire::FrameStamp& stamp, const wire::Result& result,
                             Clock::time_point arrived) {
  put(result_, Kind::kResult, stamp, result);
  if (result_) result_->arrived = arrived;
}

void AgentOutbox::put_felt(const wire::FrameStamp& stamp, const wire::ToolState& felt) {
  put(felt_, Kind::kFelt, stamp, wire::ToolStates{{felt}});
}

bool AgentOutbox::put_text(std::string_view text) {
  if (closed_) return true;
  if (control_.size() >= kControlQueueMax) return false;
  const auto bytes = std::as_bytes(std::span(text));
  control_.push_back({Kind::kText, {bytes.begin(), bytes.end()}, {}});
  return true;
}

void AgentOutbox::put_pong(const wire::FrameStamp& stamp, const wire::Pong& pong) {
  if (closed_ || control_.size() >= kControlQueueMax) return;
  Frame& frame = control_.emplace_back(Frame{Kind::kPong, {}, {}});
  wire::append(frame.bytes, stamp, pong);
}

void AgentOutbox::put_stock(const wire::FrameStamp& stamp, const wire::StockPatch& patch) {
  put(stock_, Kind::kStock, stamp, patch);
}

void AgentOutbox::close() {
  closed_ = true;
  result_.reset();
  felt_.reset();
  stock_.reset();
}

bool AgentOutbox::take_slot(std::optional<Frame>& slot, Frame& out) {
  if (!slot) return false;
  spare_ = std::move(out.bytes);
  out = *std::move(slot);
  slot.reset();
  return true;
}

bool AgentOutbox::take(Frame& out) {
  if (take_slot(result_, out) || take_slot(felt_, out)) return true;
  if (control_.empty()) return take_slot(stock_, out);
  out = std::move(control_.front());
  control_.pop_front();
  return true;
}

}  // namespace kerf::net
