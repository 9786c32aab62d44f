// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/agent_conversation.h"

#include <cassert>
#include <string>
#include <utility>

#include "server/rights/rights.h"

namespace kerf::net {

AgentConversation::AgentConversation(Setup setup)
    : Conversation(std::move(setup.session), setup.metrics, std::move(setup.now),
                   std::move(setup.wake), std::move(setup.caller)),
      limits_(setup.limits),
      open_udp_(std::move(setup.open_udp)) {
  listener_ = session().listen([this](const SessionEvent& event) { on_event(event); });
}

AgentConversation::~AgentConversation() { end(); }

void AgentConversation::end() {
  if (listener_ == 0) return;
  session().unlisten(std::exchange(listener_, 0));
  if (self_ && !left_) session().leave(self_->id);
}

std::uint64_t AgentConversation::durable_sequence() const {
  return states_durable_ && self_ ? session().durable_sequence(self_->id) : 0;
}

void AgentConversation::on_event(const SessionEvent& event) {
  if (event.replaced != 0) {
    if (!self_ || event.replaced != self_->id || std::exchange(left_, true)) return;
    batch_.reset();
    if (finishing() || broken()) return;
    say(bye_message("the agent has connected again"));
    finish();
    return wake();
  }
  if (event.removed != 0 && (!self_ || event.removed != self_->id)) return;
  if (event.removed != 0 && self_ && !std::exchange(left_, true)) {
    // The partly cut motion is completed without the peer, which may stop reading for long.
    batch_.reset();
    session().leave(self_->id);
  }
  if (finishing() || broken()) return;
  if (event.removed != 0) {
    reject({wire::ErrorCode::kRemoved, event.closing}, true);
    finish();
  } else if (!event.closing.empty()) {
    say(bye_message(event.closing, event.redirect));
    finish();
  } else if (self_ && event.tools_changed) {
    say(tools_message(*session().scene()));
  } else if (self_ && event.carvers_changed) {
    out_.put_participants(carvers_message(session().people().carvers()));
  } else {
    return;
  }
  wake();
}

void AgentConversation::on_hello(const HelloMessage& hello) {
  JoinRequest request = join_request(ParticipantKind::kAgent, hello);
  request.tool = hello.tool;
  request.feel = hello.feel;
  request.feel_of = hello.feel_of;
  request.stock = hello.stock;
  request.returned = hello.returned;
  request.whole = has_whole_ = hello.whole;
  request.intent = hello.intent;
  request.durable = hello.durable;
  request.token = hello.resume;
  const auto admission = session().admit(request);
  if (!admission) return reject_hello(admission.error());
  self_ = admission->participant;
  states_durable_ = !admission->token.empty();
  std::optional<datagram::Offer> offer;
  if (hello.udp && open_udp_) offer = open_udp_();
  has_udp_ = offer.has_value();
  servers_ = session().other_servers();
  next_servers_ = now_() + kServersInterval;
  say(agent_welcome(session(), *admission, limits_, offer ? &*offer : nullptr, hello.reach));
  out_.put_participants(carvers_message(session().people().carvers()));
}

void AgentConversation::on_control(const ControlMessage& message) {
  if (std::holds_alternative<StockMessage>(message)) return session().replicas().reset(self_->id);
  if (const auto* change = std::get_if<ChangeMessage>(&message)) {
    return change_stroke(change->undone);
  }
  if (const auto* reach = std::get_if<ReachMessage>(&message)) {
    if (reaches_.allow(now_())) return session().people().set_reach(self_->id, reach->reach);
    return reject({wire::ErrorCode::kTooFast, "'reach' is limited to 10 per second"});
  }
  const auto* tool = std::get_if<ToolMessage>(&message);
  if (tool == nullptr) {
    return reject({wire::ErrorCode::kBadMessage, "agents may not send 'look' and 'seek' messages"});
  }
  if (!tools_.allow(now_())) {
    return reject({wire::ErrorCode::kTooFast, "'tool' is limited to 10 per second"});
  }
  const auto chosen = session().people().choose_tool(self_->id, tool->tool);
  if (!chosen) reject(chosen.error());
}

/// One at a time, because each carves on a thread that all sessions share.
void AgentConversation::change_stroke(bool undone) {
  using enum wire::ErrorCode;
  const auto refuse = [&](wire::ErrorCode code, const char* reason) {
    say(stroke_message(undone, std::unexpected(Rejection{code, reason})));
  };
  if (!may(self_->role, Action::kUndo)) {
    return refuse(kNotAllowed, "the role of this participant may not undo");
  }
  if (*changes_) return refuse(kBusy, "the undo or redo before is not done yet");
  *changes_ = true;
  const StrokeRequest request{
      .undone = undone, .participant = self_->id, .author = self_->id, .caller = {}};
  session().stroke_changes().change_later(
      request, [this, undone, alive = std::weak_ptr(changes_)](const auto& changed) {
        if (alive.expired()) return;
        *changes_ = false;
        if (finishing() || broken()) return;
        say(stroke_message(undone, changed));
        wake();
      });
}

void AgentConversation::on_message(const wire::Message& message, Clock::time_point arrived) {
  if (const auto* batch = std::get_if<wire::MotionBatch>(&message.body)) {
    if (!self_) return reject_without_hello();
    assert(!batch_);
    const auto answer = apply(*batch, {.arrived = arrived, .over_udp = false});
    if (answer) queue_answer(*answer, arrived);
    return;
  }
  if (std::holds_alternative<wire::Ack>(message.body)) {
    if (!self_) return reject_without_hello();
    const auto taken = session().replicas().ack(self_->id, message.header.stamp.sequence);
    if (!taken) reject(taken.error());
    stock_due_ = true;  // as many frames as allowed may have been in flight
    return;
  }
  reject_frame_type(message, "agents");
}

std::optional<MotionAnswer> AgentConversation::apply(const wire::MotionBatch& batch,
                                                     const InProgress& from) {
  auto answer = session().begin_move(self_->id, batch.view());
  if (answer) {
    complete(*answer, from.arrived);
  } else {
    batch_ = from;
  }
  return answer;
}

void AgentConversation::complete(MotionAnswer& answer, Clock::time_point arrived) {
  for (const Rejection& rejection : answer.rejections) reject(rejection);
  answer.result.turnaround_us = static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(now_() - arrived).count());
  answer.result.durable_sequence = durable_sequence();
  gate_.applied(answer.result.agent_sequence);
  last_answer_ = answer.result;
  stock_due_ = intents_due_ = true;
}

void AgentConversation::queue_answer(const MotionAnswer& answer, Clock::time_point arrived) {
  out_.put_result(stamp(++results_), answer.result, arrived);
  if (answer.felt) out_.put_felt(stamp(++felts_), *answer.felt);
}

void AgentConversation::work() {
  if (!batch_) return;
  auto answer = session().go_on(self_->id);
  if (!answer) return;
  const InProgress done = *std::exchange(batch_, std::nullopt);
  complete(*answer, done.arrived);
  if (!done.over_udp) return queue_answer(*answer, done.arrived);
  datagrams_queued_ = datagrams_taken_ = 0;
  if (!finishing() && !broken()) queue_answer_datagrams(*answer, done.arrived);
}

/// Once no tool is near any more, sends one empty frame.
void AgentConversation::send_intents(Clock::time_point now) {
  if (!intents_due_ || now < next_intents_) return;
  intents_due_ = false;
  const wire::Intents near = session().intents(self_->id);
  if (near.count == 0 && !has_near_) return;
  has_near_ = near.count > 0;
  next_intents_ = now + kIntentInterval;
  out_.put_intents(stamp(++intents_), near);
}

void AgentConversation::refresh() {
  if (self_ && !batch_ && !finishing() && !broken()) {
    send_intents(now_());
    send_servers(now_());
  }
  // A copy of the whole block changes even while its tool rests, so its pings request updates.
  const bool is_due = stock_due_ || has_whole_;
  if (!self_ || batch_ || !is_due || finishing() || broken() || out_.has_stock()) return;
  const auto now = now_();
  if (now < next_stock_) return;
  next_stock_ = now + kStockInterval;
  const auto update = session().replicas().update(self_->id);
  stock_due_ = update.has_value();  // one frame may not hold all of it
  if (update) out_.put_stock(stamp(update->sequence), update->patch());
}

/// Sends the list of other servers if it has changed: at the start of a cluster, servers do not
/// know each other yet. An empty list is not sent, because this server may be the one that is cut
/// off.
void AgentConversation::send_servers(Clock::time_point now) {
  if (now < next_servers_) return;
  next_servers_ = now + kServersInterval;
  std::vector<std::string> others = session().other_servers();
  if (others.empty() || others == servers_) return;
  servers_ = std::move(others);
  say(servers_message(servers_));
}

void AgentConversation::receive_datagram(std::span<const std::byte> frame,
                                         Clock::time_point arrived) {
  datagrams_queued_ = datagrams_taken_ = 0;
  if (!has_udp_ || finishing() || broken()) return;
  const auto message = wire::decode(frame, wire::kMaxClientFrameBytes);
  if (!message) {
    return reject(
        {wire::protocol_error(message.error().code), std::string(message.error().reason)});
  }
  if (const auto* ping = std::get_if<wire::Ping>(&message->body)) {
    queue_datagram(++pongs_, wire::Pong{ping->time_us, to_us(now_()), durable_sequence()});
  } else if (const auto* batch = std::get_if<wire::MotionBatch>(&message->body);
             batch != nullptr && is_of_this_epoch(*message)) {
    // The agent repeats unanswered batches.
    if (!batch_) on_datagram_motion(*batch, arrived);
  }
}

/// Samples after a gap are not applied. The previous answer is repeated instead, so that the agent
/// knows where to resume.
void AgentConversation::on_datagram_motion(const wire::MotionBatch& batch,
                                           Clock::time_point arrived) {
  const Arrival arrival = gate_.judge(batch);
  if (arrival == Arrival::kNew) {
    const auto answer = apply(batch, {.arrived = arrived, .over_udp = true});
    if (answer) queue_answer_datagrams(*answer, arrived);
    return;
  }
  wire::Result repeated = last_answer_;
  if (arrival == Arrival::kGap) {
    metrics_.motion_gap();
    repeated.status |= wire::kStatusGap;
  }
  queue_datagram(++results_, repeated);
}

void AgentConversation::queue_answer_datagrams(const MotionAnswer& answer,
                                               Clock::time_point arrived) {
  if (answer.felt) queue_datagram(++felts_, wire::ToolStates{{*answer.felt}});
  queue_datagram(++results_, answer.result, arrived);
}

template <typename Body>
void AgentConversation::queue_datagram(std::uint64_t sequence, const Body& body,
                                       std::optional<Clock::time_point> arrived) {
  OutDatagram& datagram = datagrams_.at(datagrams_queued_++);
  datagram.size = wire::encode(stamp(sequence), body, datagram.bytes);
  datagram.arrived = arrived;
}

const OutDatagram* AgentConversation::take_datagram() {
  if (datagrams_taken_ == datagrams_queued_) return nullptr;
  return &datagrams_.at(datagrams_taken_++);
}

void AgentConversation::sent(const OutFrame& frame) {
  if (frame.kind != OutFrame::Kind::kResult) return;
  metrics_.motion_answered(std::chrono::duration<double>(now_() - frame.arrived).count());
}

}  // namespace kerf::net
