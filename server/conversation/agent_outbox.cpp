// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/agent_outbox.h"

#include <utility>

namespace kerf::net {

template <class Body>
void AgentOutbox::put(std::optional<OutFrame>& slot, OutFrame::Kind kind,
                      const wire::FrameStamp& stamp, const Body& body) {
  if (closed_) return;
  if (!slot) slot.emplace(OutFrame{.kind = kind, .bytes = std::exchange(spare_, {})});
  slot->bytes.clear();
  wire::append(slot->bytes, stamp, body);
}

void AgentOutbox::put_result(const wire::FrameStamp& stamp, const wire::Result& result,
                             Clock::time_point arrived) {
  put(result_, OutFrame::Kind::kResult, stamp, result);
  if (result_) result_->arrived = arrived;
}

void AgentOutbox::put_intents(const wire::FrameStamp& stamp, const wire::Intents& intents) {
  put(intents_, OutFrame::Kind::kIntent, stamp, intents);
}

void AgentOutbox::put_felt(const wire::FrameStamp& stamp, const wire::ToolState& felt) {
  put(felt_, OutFrame::Kind::kFelt, stamp, wire::ToolStates{{felt}});
}

bool AgentOutbox::put_text(std::string_view text) { return closed_ || control_.put_text(text); }

void AgentOutbox::put_pong(const wire::FrameStamp& stamp, const wire::Pong& pong) {
  if (!closed_) control_.put_pong(stamp, pong);
}

void AgentOutbox::put_stock(const wire::FrameStamp& stamp, const wire::StockPatch& patch) {
  put(stock_, OutFrame::Kind::kStock, stamp, patch);
}

void AgentOutbox::close() {
  closed_ = true;
  result_.reset();
  intents_.reset();
  felt_.reset();
  stock_.reset();
  participants_.clear();
}

bool AgentOutbox::take_slot(std::optional<OutFrame>& slot, OutFrame& out) {
  if (!slot) return false;
  spare_ = std::move(out.bytes);
  out = std::move(*slot);
  slot.reset();
  return true;
}

bool AgentOutbox::take(OutFrame& out) {
  return take_slot(result_, out) || take_slot(intents_, out) || take_slot(felt_, out) ||
         control_.take(out) || take_text(participants_, OutFrame::Kind::kParticipants, out) ||
         take_slot(stock_, out);
}

}  // namespace kerf::net
