// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/traffic.h"

#include <algorithm>
#include <utility>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/link/control_message.h"
#include "server/wire/codec.h"

namespace kerf::agent {
namespace {

constexpr std::uint64_t kPingEveryUs = 100'000;
/// The server accepts 10 'reach' messages per second. A program may change its mapping in each
/// tick.
constexpr std::uint64_t kReachEveryUs = 100'000;
/// Period of pings while the link waits only for the server's disk.
constexpr std::uint64_t kLastPingsEveryUs = 20'000;
constexpr unsigned kHttpClientError = 400;
constexpr unsigned kHttpTooMany = 429;
constexpr unsigned kHttpServerError = 500;

}  // namespace

Loss declined(const std::string& session, unsigned status, std::string_view body) {
  const std::string said = reason_of_body(body);
  std::string reason = "the server rejected session '" + session + "': ";
  if (!said.empty()) reason += said + " (HTTP " + std::to_string(status) + ")";
  if (said.empty()) reason += "HTTP " + std::to_string(status);
  const bool final =
      status >= kHttpClientError && status < kHttpServerError && status != kHttpTooMany;
  return {std::move(reason), final};
}

void Traffic::begin(std::uint32_t epoch, std::uint32_t tool_id, std::uint64_t now_us,
                    bool udp_offered, std::optional<std::uint64_t> server_has) {
  ++report_.connections;
  epoch_ = epoch;
  tool_id_ = tool_id;
  motion_sequence_ = ping_sequence_ = pong_sequence_ = 0;
  next_ping_us_ = now_us;
  pong_due_.reset();
  ack_due_.reset();  // it belongs to the previous connection
  asked_.clear();
  queue_.keep_until_durable(server_has.has_value());
  queue_.rewind(server_has.value_or(0));
  newest_result_ = newest_felt_ = 0;
  base_ = 0;
  based_ = false;
  progress_us_ = now_us;
  next_reach_us_ = now_us;
  transport_.begin(udp_offered, now_us);
  report_.udp.offered |= udp_offered;
}

bool Traffic::settle(std::uint64_t now_us) noexcept {
  if (settled()) return true;
  if (queue_.settled()) next_ping_us_ = std::min(next_ping_us_, now_us + kLastPingsEveryUs);
  return false;
}

std::size_t Traffic::collect() {
  std::size_t count = 0;
  wire::MotionSample sample;
  while (ring_.pop(sample)) {
    ++count;
    take_buttons(sample);
    if (options_.deadband && holds_back(sample)) {
      held_ = sample;
      ++report_.held_back;
      continue;
    }
    // A cut starts at the last measured pose, not at the last one sent.
    const bool cuts = (sample.buttons & wire::kButtonCutting) != 0;
    if (held_ && cuts) queue_.push(*held_);
    held_.reset();
    queue_.push(sample);
    queued_ = sample;
  }
  return count;
}

/// Removes the buttons that are not part of the protocol. Their presses become requests.
void Traffic::take_buttons(wire::MotionSample& sample) {
  const std::uint32_t now = sample.buttons & (kButtonUndo | kButtonRedo);
  const std::uint32_t pressed = now & ~std::exchange(pressed_, now);
  sample.buttons &= ~now;
  if ((pressed & kButtonUndo) != 0) ask(true);
  if ((pressed & kButtonRedo) != 0) ask(false);
}

/// Returns true for poses out of contact that differ imperceptibly from the last one, for at most
/// one heartbeat: a longer silence must still indicate a failure.
bool Traffic::holds_back(const wire::MotionSample& sample) const noexcept {
  constexpr double kDeadbandMm = 0.05;
  constexpr double kDeadbandRad = 1e-3;
  constexpr std::uint64_t kHeartbeatUs = 10'000;
  if (!out_of_contact_ || !queued_ || sample.buttons != queued_->buttons) return false;
  if ((sample.buttons & wire::kButtonCutting) != 0) return false;
  if (sample.tool_id != queued_->tool_id) return false;
  if (sample.time_us >= queued_->time_us + kHeartbeatUs) return false;
  const Vec3 moved = sample.tip_mm - queued_->tip_mm;
  const Vec3 turned = Vec3(sample.axis) - Vec3(queued_->axis);
  return dot(moved, moved) < kDeadbandMm * kDeadbandMm &&
         dot(turned, turned) < kDeadbandRad * kDeadbandRad;
}

/// Returns whether to send the reach now. A change within kReachEveryUs after the last message is
/// due at the end of that time.
bool Traffic::take_reach(std::uint64_t now_us) noexcept {
  if (options_.reach == nullptr || !reach_taken_) return false;
  Reach reach;
  if (options_.reach->read(reach)) {
    device_reach_ = reach;
    reach_due_ = true;
  }
  if (!device_reach_ || !reach_due_ || now_us < next_reach_us_) return false;
  reach_due_ = false;
  next_reach_us_ = now_us + kReachEveryUs;
  return true;
}

std::string Traffic::take_control(std::uint64_t now_us) {
  if (take_reach(now_us)) return reach_text(*device_reach_);
  if (options_.copy != nullptr && options_.copy->wants_reset()) return stock_text();
  if (!asked_.empty() && !(transport_.over_udp() && queue_.in_flight())) {
    leave_udp();
    if (queue_.unsent() == 0) {
      base_ = 0;
      const bool undone = asked_.front();
      asked_.pop_front();
      return change_text(undone);
    }
  }
  const auto tool = queue_.next_tool();
  if (!tool || *tool == tool_id_) return {};
  leave_udp();
  if (queue_.next_tool() == tool_id_) return {};
  base_ = 0;
  tool_id_ = *tool;
  return tool_text(tool_id_);
}

/// Call before a message that the WebSocket carries in order with the samples. Earlier samples
/// precede it there, and UDP must wait until a later one is answered.
void Traffic::leave_udp() {
  base_.reset();
  based_ = false;
  if (!transport_.over_udp()) return;
  transport_.leave();
  queue_.go_back();
}

std::size_t Traffic::fill(std::uint64_t now_us, std::span<std::byte> frame) {
  choose_transport(now_us);
  if (pong_due_) {
    const wire::Pong pong{.ping_time_us = *pong_due_, .time_us = now_us};
    pong_due_.reset();
    return wire::encode(stamp(++pong_sequence_, now_us), pong, frame);
  }
  if (ack_due_) {
    const std::uint64_t sequence = *ack_due_;
    ack_due_.reset();
    return wire::encode(stamp(sequence, now_us), wire::Ack{}, frame);
  }
  // While UDP is in use, pings use it too, to measure its round trip.
  if (transport_.over_udp()) return 0;
  if (now_us >= next_ping_us_) {
    next_ping_us_ = now_us + kPingEveryUs;
    return wire::encode(stamp(++ping_sequence_, now_us), wire::Ping{now_us}, frame);
  }
  const std::size_t most = pace_.allowed(now_us);
  if (most == 0 || queue_.unsent() == 0) return 0;
  const wire::MotionBatch batch = queue_.take(most);
  if (batch.count == 0) return 0;
  pace_.sent(batch.count);
  report_.samples_sent += batch.count;
  ++report_.messages_sent;
  if (base_ && *base_ == 0) base_ = batch.samples[0].agent_sequence;
  return wire::encode(stamp(++motion_sequence_, now_us), batch, frame);
}

std::optional<Loss> Traffic::take_text(std::string_view text, std::string& notice) {
  const auto message = parse_control(text);
  if (!message) {
    ++report_.bad_frames;
    return std::nullopt;
  }
  if (const auto* bye = std::get_if<Bye>(&*message)) {
    return Loss{"the server closed the connection: " + bye->reason, false, bye->redirect};
  }
  if (const auto* servers = std::get_if<ServersChanged>(&*message)) {
    servers_ = servers->others;
    return std::nullopt;
  }
  if (const auto* changed = std::get_if<StrokeChanged>(&*message)) {
    notice =
        "stroke " + std::to_string(changed->stroke) + (changed->undone ? " undone" : " redone");
    return std::nullopt;
  }
  if (const auto* refused = std::get_if<ChangeRefused>(&*message)) {
    notice = std::string("cannot ") + (refused->undone ? "undo: " : "redo: ") + refused->reason;
    return std::nullopt;
  }
  const auto* error = std::get_if<ServerError>(&*message);
  if (error == nullptr) return std::nullopt;
  ServerComplaint& complaint = report_.complaints[error->code];
  if (complaint.count++ == 0) {
    complaint.first_reason = error->reason;
    notice = "server: " + error->code + ": " + error->reason;
  }
  if (!error->fatal) return std::nullopt;
  return Loss{error->code + ": " + error->reason, true};
}

std::optional<Loss> Traffic::take_frame(std::span<const std::byte> frame, std::uint64_t now_us) {
  const auto message = wire::decode(frame);
  if (!message) {
    ++report_.bad_frames;
    return std::nullopt;
  }
  if (std::holds_alternative<wire::StockPatch>(message->body)) {
    ack_due_ = message->header.stamp.sequence;
    if (options_.copy != nullptr) options_.copy->take_stock(frame);
    return std::nullopt;
  }
  if (std::holds_alternative<wire::Intents>(message->body)) {
    if (options_.copy != nullptr) options_.copy->take_stock(frame);
    return std::nullopt;
  }
  return take_message(*message, now_us);
}

std::optional<Loss> Traffic::take_message(const wire::Message& message, std::uint64_t now_us) {
  if (const auto* result = std::get_if<wire::Result>(&message.body)) {
    if (message.header.stamp.epoch != epoch_) return Loss{"the session has been rebuilt"};
    take_result(*result, now_us);
    queue_.durable(result->durable_sequence);
  } else if (const auto* pong = std::get_if<wire::Pong>(&message.body)) {
    take_pong(*pong, now_us);
    queue_.durable(pong->durable_sequence);
  } else if (const auto* states = std::get_if<wire::ToolStates>(&message.body)) {
    take_felt(*states);
  } else if (const auto* ping = std::get_if<wire::Ping>(&message.body)) {
    pong_due_ = ping->time_us;
  }
  return std::nullopt;
}

void Traffic::take_pong(const wire::Pong& pong, std::uint64_t now_us) {
  report_.clock.take(pong.ping_time_us, pong.time_us, now_us);
  const std::uint64_t rtt_us = now_us > pong.ping_time_us ? now_us - pong.ping_time_us : 0;
  // Extend the window, because a long round trip does not mean that the server is slow.
  queue_.set_rtt(rtt_us);
  if (options_.status == nullptr) return;
  options_.status->write({.connections = report_.connections,
                          .samples_sent = report_.samples_sent,
                          .results = report_.results,
                          .rtt_us = rtt_us,
                          .clock_offset_us = report_.clock.offset_us(),
                          .udp = udp_report()});
}

void Traffic::take_felt(const wire::ToolStates& states) {
  felt_ = {};
  for (const wire::ToolState& state : states.tools) {
    felt_ = {.force_n = Vec3(state.force_n), .torque_nmm = Vec3(state.torque_nmm)};
  }
}

void Traffic::take_result(const wire::Result& result, std::uint64_t now_us) {
  if ((result.status & wire::kStatusGap) != 0) take_gap(now_us);
  if (result.agent_sequence <= newest_result_) {
    ++report_.old_results;
    return;
  }
  note_progress(result, now_us);
  ServerWrench answer = answer_of(result, now_us);
  answer.felt = felt_;
  wrenches_.write(answer);
  if (options_.copy != nullptr) options_.copy->take_result(result);
  constexpr std::uint32_t kFelt = wire::kStatusCutting | wire::kStatusColliding;
  out_of_contact_ = (result.status & kFelt) == 0 && result.plane_count == 0;
  queue_.answered(result.agent_sequence);
  ++report_.results;
  if ((result.status & wire::kStatusRejected) != 0) ++report_.rejected_results;
  if ((result.status & wire::kStatusImprint) != 0) ++report_.imprint_results;
  report_.motions_in_session = result.motions_applied;
  report_.removed_mm3 += static_cast<double>(result.removed_mm3);
  report_.max_server_force_n = std::max(report_.max_server_force_n, length(answer.wrench.force_n));
  if (now_us >= result.agent_time_us) report_.answer_us.add(now_us - result.agent_time_us);
  report_.turnaround_us.add(result.turnaround_us);
}

LinkReport Traffic::report() const {
  LinkReport report = report_;
  report.resent = queue_.resent();
  report.merged_air = queue_.merged_air();
  report.merged_cuts = queue_.merged_cuts();
  report.thinned_cuts = queue_.thinned_cuts();
  report.forgotten = queue_.forgotten();
  report.unanswered = queue_.unanswered();
  report.not_durable = queue_.not_durable();
  report.given_up = queue_.given_up();
  report.udp = udp_report();
  return report;
}

}  // namespace kerf::agent
