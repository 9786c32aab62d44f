// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "haptic_agent/link/lane_switch.h"
#include "haptic_agent/link/link_report.h"
#include "haptic_agent/link/pace.h"
#include "haptic_agent/link/sample_queue.h"
#include "haptic_agent/link/stock_listener.h"
#include "haptic_agent/servo/latest_value.h"
#include "haptic_agent/servo/sample_ring.h"
#include "haptic_agent/servo/wrench_interpolator.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// Why a connection ended. A final one is not tried again.
struct Loss {
  std::string reason;
  bool final = false;
};

/// What it means that a server answers the wish for a WebSocket with an HTTP status and a body: the
/// client's own faults (4xx) are final, but for "too many requests".
Loss declined(const std::string& session, unsigned status, std::string_view body);

struct TrafficOptions {
  /// Poses out of contact that a hand could not tell from the last one are not sent.
  bool deadband = false;
  /// Where to show how the link is doing; may be null.
  LatestValue<LinkStatus>* status = nullptr;
  /// Who keeps a copy of the block; null: nobody, and the server is not asked for it.
  StockListener* copy = nullptr;
};

/// What goes over a connection and what comes back, apart from the connection itself: decides which
/// frame is due, reads each that comes, and keeps the count. Used by the link's thread only.
class Traffic {
 public:
  /// Both references must outlive it.
  Traffic(SampleRing& samples, LatestValue<ServerWrench>& wrenches, TrafficOptions options = {})
      : ring_(samples), wrenches_(wrenches), options_(options) {}

  /// A connection has been made and welcomed; `tool_id` is the one named in the hello.
  void begin(std::uint32_t epoch, std::uint32_t tool_id, std::uint64_t now_us,
             bool udp_offered = false);
  /// The user wants the UDP lane, whether there is one or not.
  void ask_for_udp() noexcept { report_.udp.asked = true; }

  /// Takes what the servo has left in the ring.
  void collect();
  /// True if every sample that was collected is answered.
  bool settled() const noexcept { return queue_.settled(); }

  /// The control message that is due before the next frame, e.g. that the tool has changed; empty:
  /// none.
  std::string take_control();
  /// Encodes the next binary frame that is due into `frame` (kMaxClientFrameBytes); its size, or 0.
  std::size_t fill(std::uint64_t now_us, std::span<std::byte> frame);
  /// The same for the UDP lane (datagram::kMaxFrameBytes).
  std::size_t fill_datagram(std::uint64_t now_us, std::span<std::byte> frame);

  /// A frame has come: why the connection must end, if so; `notice` is what the user should read.
  std::optional<Loss> take_text(std::string_view text, std::string& notice);
  std::optional<Loss> take_frame(std::span<const std::byte> frame, std::uint64_t now_us);
  std::optional<Loss> take_datagram(std::span<const std::byte> frame, std::uint64_t now_us);
  /// What the user should read of the UDP lane; empty if nothing.
  std::string take_notice();
  /// Counted by whoever has the UDP socket.
  UdpReport& udp_counts() noexcept { return report_.udp; }

  /// The counts so far, those of the queue included.
  LinkReport report() const;

 private:
  bool holds_back(const wire::MotionSample& sample) const noexcept;
  void take_pong(const wire::Pong& pong, std::uint64_t now_us);
  void take_felt(const wire::ToolStates& states);
  void take_result(const wire::Result& result, std::uint64_t now_us);
  std::optional<Loss> take_message(const wire::Message& message, std::uint64_t now_us);
  UdpReport udp_report() const;
  void choose_lane(std::uint64_t now_us);
  void repeat_what_is_lost(std::uint64_t now_us);
  void take_gap(std::uint64_t now_us);
  void note_progress(const wire::Result& result, std::uint64_t now_us);
  wire::FrameStamp stamp(std::uint64_t sequence, std::uint64_t now_us) const noexcept {
    return {.epoch = epoch_, .sequence = sequence, .time_us = now_us};
  }

  SampleRing& ring_;
  LatestValue<ServerWrench>& wrenches_;
  TrafficOptions options_;
  SampleQueue queue_;
  /// The last sample that went into the queue, and one behind it that was held back.
  std::optional<wire::MotionSample> queued_;
  std::optional<wire::MotionSample> held_;
  /// The newest result has nothing to feel in it.
  bool out_of_contact_ = false;
  Wrench felt_;
  Pace pace_;
  LinkReport report_;
  std::uint32_t epoch_ = 0;
  std::uint32_t tool_id_ = 0;
  std::uint64_t motion_sequence_ = 0;
  std::uint64_t ping_sequence_ = 0;
  std::uint64_t pong_sequence_ = 0;
  std::uint64_t next_ping_us_ = 0;
  std::optional<std::uint64_t> pong_due_;
  std::uint64_t newest_result_ = 0;

  LaneSwitch lanes_;
  /// The first sample after which the order of the WebSocket no longer matters: of a connection, or
  /// of a new tool. 0: it has not gone out yet; none: the new tool has not been told yet.
  std::optional<std::uint64_t> base_ = 0;
  /// The server has answered the base.
  bool based_ = false;
  std::uint64_t progress_us_ = 0;
  std::uint64_t went_back_us_ = 0;
  /// Repetitions since the last progress; the silence ends them before they are many.
  unsigned vain_repeats_ = 0;
  std::uint64_t udp_rtt_us_ = 0;
  std::uint64_t newest_felt_ = 0;
  /// The stock frame to be acknowledged.
  std::optional<std::uint64_t> ack_due_;
};

}  // namespace kerf::agent
