// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/viewer_conversation.h"

#include <utility>

namespace kerf::net {

ViewerConversation::ViewerConversation(std::shared_ptr<Session> session, Metrics& metrics, Now now,
                                       std::function<void()> wake, Caller caller,
                                       std::uint32_t budget_max)
    : Conversation(std::move(session), metrics, std::move(now), std::move(wake), std::move(caller)),
      budget_max_(budget_max),
      budget_(budget_max) {}

void ViewerConversation::set_budget(std::uint32_t stated) {
  const bool is_bounded = budget_max_ > 0 && (stated == 0 || stated > budget_max_);
  budget_ = is_bounded ? budget_max_ : stated;
}

std::optional<ViewerAction> ViewerConversation::take_action() {
  if (actions_.empty()) return std::nullopt;
  ViewerAction action = std::move(actions_.front());
  actions_.pop_front();
  return action;
}

void ViewerConversation::on_hello(const HelloMessage& hello) {
  takes_changes_ = hello.changes;
  const TileNodes nodes = hello.repeat ? TileNodes::kRepeated : TileNodes::kSingle;
  first_look_ = {hello.look_follows, hello.look, hello.verify ? TileNodes::kVerified : nodes};
  set_budget(hello.budget);
  JoinRequest request = join_request(ParticipantKind::kViewer, hello);
  request.feel = false;
  hello_waits_ = true;
  actions_.emplace_back(std::move(request));
}

void ViewerConversation::joined(const std::expected<Participant, Rejection>& self,
                                const Roster& roster) {
  hello_waits_ = false;
  if (self) {
    self_ = *self;
    say_welcome(roster);
  } else {
    reject_hello(self.error());
  }
  wake();
}

void ViewerConversation::say_welcome(const Roster& roster) {
  const auto meshes = verifies() ? std::optional(meshes_before_) : std::nullopt;
  say(viewer_welcome(session(), *self_, roster, budget_, meshes));
}

void ViewerConversation::queue_pong(const wire::FrameStamp& stamp, const wire::Pong& pong) {
  const std::uint64_t sent = verifies() ? out_.mesh_sent() : 0;
  out_.put_pong(stamp, {pong.ping_time_us, pong.time_us, sent});
}

void ViewerConversation::on_control(const ControlMessage& message) {
  if (const auto* seek = std::get_if<SeekMessage>(&message)) {
    if (!seeks_.allow(now_())) {
      return reject({wire::ErrorCode::kTooFast, "'seek' is limited to 20 per second"});
    }
    sent_state_.reset();  // answers even if nothing changes
    actions_.emplace_back(*seek);
    return;
  }
  if (const auto* camera = std::get_if<CameraMessage>(&message)) {
    if (!cameras_.allow(now_())) {
      return reject({wire::ErrorCode::kTooFast, "'camera' is limited to 20 per second"});
    }
    actions_.emplace_back(*camera);
    return;
  }
  const auto* look = std::get_if<LookMessage>(&message);
  if (look == nullptr) {
    return reject({wire::ErrorCode::kBadMessage,
                   "viewers may send only 'hello', 'look', 'seek' and 'camera'"});
  }
  if (!looks_.allow(now_())) {
    return reject({wire::ErrorCode::kTooFast, "'look' is limited to 5 per second"});
  }
  if (look->budget) {
    set_budget(*look->budget);
    actions_.emplace_back(ViewerBudget{budget_});
  }
  actions_.emplace_back(look->look);
}

void ViewerConversation::on_message(const wire::Message& message, Clock::time_point) {
  if (!std::holds_alternative<wire::Ack>(message.body))
    return reject_frame_type(message, "viewers");
  if (!self_) return reject_without_hello();
  const std::uint64_t sequence = message.header.stamp.sequence;
  if (sequence == 0 || sequence > meshes_before_) {
    actions_.emplace_back(MeshAck{sequence - meshes_before_});
  }
}

void ViewerConversation::begin_again(const Roster& roster) {
  if (finishing()) return;
  out_.drop_surface();
  meshes_before_ = meshes_;
  sent_state_.reset();
  say_welcome(roster);
  wake();
}

void ViewerConversation::send_tools(SharedBytes frame) {
  out_.put_tools(std::move(frame));
  wake();
}

void ViewerConversation::send_mesh(FeedFrame frame, SharedBytes tools) {
  if (tools) out_.put_tools(std::move(tools));
  frame.sequence += meshes_before_;
  meshes_ = frame.sequence;
  out_.put_mesh(std::move(frame), verifies());
  wake();
}

void ViewerConversation::send_state(const SurfaceState& state) {
  const bool same = sent_state_ && sent_state_->sequence == state.sequence &&
                    sent_state_->hash == state.hash && sent_state_->settled == state.settled &&
                    sent_state_->paused == state.paused && sent_state_->past == state.past;
  const auto now = now_();
  if (same || (!state.settled && now - state_sent_at_ < kStateInterval)) return;
  sent_state_ = state;
  state_sent_at_ = now;
  out_.put_state(state_message(state.motions, state.removed_mm3, state.hash, state.settled,
                               state.paused, state.past));
  wake();
}

void ViewerConversation::send_participants(const SharedText& all, const SharedText& change) {
  // A change is useful only to a viewer that gets every one. The list replaces changes that a slow
  // viewer has not read yet.
  const bool in_step = takes_changes_ && has_participants_ && !out_.has_participants();
  has_participants_ = true;
  out_.put_participants(in_step ? change : all);
  wake();
}

void ViewerConversation::send_programs(SharedText programs) {
  out_.put_programs(std::move(programs));
  wake();
}

void ViewerConversation::send_matter(std::size_t matter, SharedText text) {
  out_.put_matter(matter, std::move(text));
  wake();
}

void ViewerConversation::send_cameras(SharedText cameras) {
  out_.put_cameras(std::move(cameras));
  wake();
}

void ViewerConversation::reject_ack() {
  if (finishing()) return;
  reject({wire::ErrorCode::kBadSequence, "ack of a mesh frame that was never sent"});
  wake();
}

void ViewerConversation::reject_request(const Rejection& rejection) {
  if (finishing()) return;
  reject(rejection);
  wake();
}

void ViewerConversation::remove(const std::string& reason) {
  if (finishing()) return;
  reject({wire::ErrorCode::kRemoved, reason}, true);
  finish();
  wake();
}

void ViewerConversation::close(const std::string& reason, const std::string& redirect) {
  if (finishing()) return;
  say(bye_message(reason, redirect));
  finish();
  wake();
}

bool ViewerConversation::take(OutFrame& out) {
  if (!out_.take({session().epoch(), 0, to_us(now_())}, out)) return false;
  if (out.kind == OutFrame::Kind::kMesh) metrics_.mesh_sent(out.shared->size());
  return true;
}

}  // namespace kerf::net
