// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/conversation.h"

#include <string>
#include <utility>

namespace kerf::net {

Conversation::Conversation(std::shared_ptr<Session> session, Metrics& metrics, Now now,
                           std::function<void()> wake, Caller caller)
    : metrics_(metrics),
      now_(std::move(now)),
      session_(std::move(session)),
      wake_(std::move(wake)),
      caller_(std::move(caller)) {}

void Conversation::receive(std::span<const std::byte> frame, bool is_text,
                           Clock::time_point arrived) {
  if (finishing_ || broken_) return;
  if (frame.size() > wire::kMaxClientFrameBytes) {
    return reject({wire::ErrorCode::kTooLarge, "the frame has " + std::to_string(frame.size()) +
                                                   " bytes; the limit is " +
                                                   std::to_string(wire::kMaxClientFrameBytes)});
  }
  if (is_text) return receive_text({reinterpret_cast<const char*>(frame.data()), frame.size()});
  receive_binary(frame, arrived);
}

void Conversation::receive_text(std::string_view text) {
  if (!texts_.allow(now_())) {
    return reject({wire::ErrorCode::kTooFast, "text frames are limited to 100 per second"});
  }
  const auto message = parse_control(text);
  if (!message) return reject(message.error());
  if (const auto* hello = std::get_if<HelloMessage>(&*message)) {
    if (self_) return reject({wire::ErrorCode::kBadMessage, "hello may be sent only once"});
    return on_hello(*hello);
  }
  if (!self_) return reject_without_hello();
  on_control(*message);
}

void Conversation::receive_binary(std::span<const std::byte> frame, Clock::time_point arrived) {
  const auto message = wire::decode(frame, wire::kMaxClientFrameBytes);
  if (!message) {
    return reject({wire::protocol_error(message.error().code),
                   std::string(message.error().reason) + " (byte " +
                       std::to_string(message.error().offset) + " of the frame)"});
  }
  if (const auto* ping = std::get_if<wire::Ping>(&message->body)) {
    if (!pings_.allow(now_())) return metrics_.rejected(wire::to_string(wire::ErrorCode::kTooFast));
    return queue_pong(stamp(++pongs_), {ping->time_us, to_us(now_())});
  }
  const bool skipped = std::holds_alternative<wire::UnknownBody>(message->body) ||
                       std::holds_alternative<wire::Pong>(message->body);
  if (!skipped && is_of_this_epoch(*message)) on_message(*message, arrived);
}

bool Conversation::is_of_this_epoch(const wire::Message& message) {
  const std::uint32_t epoch = message.header.stamp.epoch;
  if (!self_ || epoch == session_->epoch()) return true;
  reject({wire::ErrorCode::kBadEpoch, "the frame is of epoch " + std::to_string(epoch) +
                                          ", the session is in epoch " +
                                          std::to_string(session_->epoch())});
  return false;
}

void Conversation::hello_expired() {
  if (self_ || hello_waits_ || finishing_ || broken_) return;
  reject({wire::ErrorCode::kNoHello, "no hello within 5 s"}, true);
  finish();
}

void Conversation::grant_expired() {
  if (finishing_ || broken_) return;
  reject({wire::ErrorCode::kNotAllowed, "the invitation has expired"}, true);
  finish();
}

JoinRequest Conversation::join_request(ParticipantKind kind, const HelloMessage& hello) const {
  JoinRequest request;
  request.kind = kind;
  request.name = caller_.name.empty() ? hello.name : caller_.name;
  request.color = caller_.color.empty() ? hello.color : caller_.color;
  request.role = caller_.role;
  request.grant = caller_.grant;
  request.is_personal = caller_.is_personal;
  request.invitation = caller_.invitation;
  request.is_muted = caller_.is_muted;
  request.network = caller_.network;
  return request;
}

void Conversation::reject_hello(const Rejection& rejection) {
  const bool fatal =
      rejection.code == wire::ErrorCode::kBusy || rejection.code == wire::ErrorCode::kNotAllowed;
  reject(rejection, fatal);
  if (fatal) finish();
}

void Conversation::reject(const Rejection& rejection, bool fatal) {
  metrics_.rejected(wire::to_string(rejection.code));
  if (fatal || errors_.allow(now_())) say(error_message(rejection, fatal));
}

void Conversation::reject_without_hello() {
  reject({wire::ErrorCode::kNoHello, "the first message must be a hello"});
}

void Conversation::reject_frame_type(const wire::Message& message, std::string_view kind) {
  const auto type = std::to_string(static_cast<unsigned>(message.header.type));
  reject(
      {wire::ErrorCode::kBadMessage, std::string(kind) + " may not send frames of type " + type});
}

void Conversation::say(std::string_view text) {
  if (!broken_ && !queue_text(text)) broken_ = true;
}

void Conversation::finish() {
  finishing_ = true;
  discard_updates();
}

}  // namespace kerf::net
