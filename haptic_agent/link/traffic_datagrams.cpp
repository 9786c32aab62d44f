// SPDX-License-Identifier: Apache-2.0
// What goes over the UDP lane, which may lose, repeat and reorder it.
#include <algorithm>

#include "haptic_agent/link/traffic.h"
#include "server/wire/codec.h"

namespace kerf::agent {
namespace {

/// An answer is late, and what it answers lost, after half as much again as a round trip, and the
/// time that a busy server may take.
constexpr std::uint64_t kPatienceUs = 20'000;

constexpr std::uint64_t late_after_us(std::uint64_t rtt_us) noexcept {
  return rtt_us + rtt_us / 2 + kPatienceUs;
}

}  // namespace

void Traffic::choose_lane(std::uint64_t now_us) {
  if (!queue_.in_flight()) progress_us_ = now_us;
  const bool was = lanes_.over_udp();
  if (lanes_.update(now_us, based_, now_us - progress_us_, udp_rtt_us_)) queue_.go_back();
  // A new lane has its own time to answer in.
  if (was == lanes_.over_udp()) return;
  progress_us_ = went_back_us_ = now_us;
  vain_repeats_ = 0;
}

std::size_t Traffic::fill_datagram(std::uint64_t now_us, std::span<std::byte> frame) {
  choose_lane(now_us);
  if (lanes_.probe_due(now_us)) {
    return wire::encode(stamp(++ping_sequence_, now_us), wire::Ping{now_us}, frame);
  }
  if (!lanes_.over_udp()) return 0;
  repeat_what_is_lost(now_us);
  // A new tool is told over the WebSocket first.
  const auto out = queue_.take_repeating(pace_.allowed(now_us), tool_id_);
  if (out.batch.count == 0) return 0;
  // The server counts each number once.
  pace_.sent(out.fresh);
  report_.samples_sent += out.due;
  report_.udp.samples += out.fresh;
  ++report_.messages_sent;
  return wire::encode(stamp(++motion_sequence_, now_us), out.batch, frame);
}

/// Where nothing new comes that could show the server a gap, and where the answers are lost; each
/// time in vain doubles the wait.
void Traffic::repeat_what_is_lost(std::uint64_t now_us) {
  if (!queue_.in_flight()) return;
  const std::uint64_t since_us = std::max(progress_us_, went_back_us_);
  if (now_us - since_us <= late_after_us(udp_rtt_us_) << vain_repeats_) return;
  queue_.go_back();
  went_back_us_ = now_us;
  ++vain_repeats_;
}

/// Every datagram that was on its way behind the lost ones brings this answer: one of them counts.
void Traffic::take_gap(std::uint64_t now_us) {
  if (!lanes_.over_udp()) return;
  ++report_.udp.gaps;
  if (now_us - went_back_us_ <= late_after_us(udp_rtt_us_)) return;
  queue_.go_back();
  went_back_us_ = now_us;
}

void Traffic::note_progress(const wire::Result& result, std::uint64_t now_us) {
  newest_result_ = result.agent_sequence;
  progress_us_ = now_us;
  vain_repeats_ = 0;
  if (base_.value_or(0) != 0 && result.agent_sequence >= *base_) based_ = true;
}

std::optional<Loss> Traffic::take_datagram(std::span<const std::byte> frame, std::uint64_t now_us) {
  const auto message = wire::decode(frame);
  if (!message) {
    ++report_.bad_frames;
    return std::nullopt;
  }
  lanes_.heard();
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
  report.carries = lanes_.over_udp();
  report.repeated = queue_.repeated();
  report.taken_over = lanes_.taken_over();
  report.fell_back = lanes_.fell_back();
  return report;
}

std::string Traffic::take_notice() { return lanes_.take_notice(); }

}  // namespace kerf::agent
