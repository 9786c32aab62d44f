// SPDX-License-Identifier: Apache-2.0
// The UDP part of Traffic. UDP may lose, duplicate and reorder frames.
#include <algorithm>

#include "haptic_agent/link/traffic.h"
#include "server/wire/codec.h"

namespace kerf::agent {
namespace {

/// A sample counts as lost if it is unanswered after 1.5 round trips plus this time for the server.
constexpr std::uint64_t kPatienceUs = 20'000;

constexpr std::uint64_t late_after_us(std::uint64_t rtt_us) noexcept {
  return rtt_us + rtt_us / 2 + kPatienceUs;
}

}  // namespace

void Traffic::choose_transport(std::uint64_t now_us) {
  if (!queue_.in_flight()) progress_us_ = now_us;
  const bool was = transport_.over_udp();
  if (transport_.update(now_us, based_, now_us - progress_us_, udp_rtt_us_)) queue_.go_back();
  // The new transport gets its own timeout.
  if (was == transport_.over_udp()) return;
  progress_us_ = went_back_us_ = now_us;
  fruitless_resends_ = 0;
}

std::size_t Traffic::fill_datagram(std::uint64_t now_us, std::span<std::byte> frame) {
  choose_transport(now_us);
  if (transport_.probe_due(now_us)) {
    return wire::encode(stamp(++ping_sequence_, now_us), wire::Ping{now_us}, frame);
  }
  if (!transport_.over_udp()) return 0;
  resend_lost(now_us);
  // A tool change is sent over the WebSocket first; until then only samples of the old tool are
  // due. A request waits until all samples in flight are answered, so no new ones are sent.
  const std::size_t most = asked_.empty() ? pace_.allowed(now_us) : 0;
  const auto out = queue_.take_repeating(most, tool_id_);
  if (out.batch.count == 0) return 0;
  // The server counts each number once.
  pace_.sent(out.fresh);
  report_.samples_sent += out.due;
  report_.udp.samples += out.fresh;
  ++report_.messages_sent;
  return wire::encode(stamp(++motion_sequence_, now_us), out.batch, frame);
}

/// Resends unanswered samples after a timeout. This is needed if no new samples reveal the gap to
/// the server, or if the answers are lost. The timeout doubles with each resend without progress.
void Traffic::resend_lost(std::uint64_t now_us) {
  if (!queue_.in_flight()) return;
  const std::uint64_t since_us = std::max(progress_us_, went_back_us_);
  if (now_us - since_us <= late_after_us(udp_rtt_us_) << fruitless_resends_) return;
  queue_.go_back();
  went_back_us_ = now_us;
  ++fruitless_resends_;
}

/// Handles a gap answer. Every datagram in flight behind the lost ones causes one. Only the first
/// counts.
void Traffic::take_gap(std::uint64_t now_us) {
  if (!transport_.over_udp()) return;
  ++report_.udp.gaps;
  if (now_us - went_back_us_ <= late_after_us(udp_rtt_us_)) return;
  queue_.go_back();
  went_back_us_ = now_us;
}

void Traffic::note_progress(const wire::Result& result, std::uint64_t now_us) {
  newest_result_ = result.agent_sequence;
  progress_us_ = now_us;
  fruitless_resends_ = 0;
  if (base_.value_or(0) != 0 && result.agent_sequence >= *base_) based_ = true;
}

std::optional<Loss> Traffic::take_datagram(std::span<const std::byte> frame, std::uint64_t now_us) {
  const auto message = wire::decode(frame);
  if (!message) {
    ++report_.bad_frames;
    return std::nullopt;
  }
  transport_.note_datagram();
  if (const auto* pong = std::get_if<wire::Pong>(&message->body)) {
    udp_rtt_us_ = now_us > pong->ping_time_us ? now_us - pong->ping_time_us : 0;
  }
  if (std::holds_alternative<wire::ToolStates>(message->body)) {
    if (message->header.stamp.sequence <= newest_felt_) return std::nullopt;
    newest_felt_ = message->header.stamp.sequence;
  }
  if (std::holds_alternative<wire::Ping>(message->body)) return std::nullopt;
  return take_message(*message, now_us);
}

UdpReport Traffic::udp_report() const {
  UdpReport report = report_.udp;
  report.carries = transport_.over_udp();
  report.repeated = queue_.repeated();
  report.taken_over = transport_.taken_over();
  report.fell_back = transport_.fell_back();
  return report;
}

std::string Traffic::take_notice() { return transport_.take_notice(); }

}  // namespace kerf::agent
