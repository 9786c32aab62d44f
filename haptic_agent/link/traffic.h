// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptic_agent/link/link_report.h"
#include "haptic_agent/link/pace.h"
#include "haptic_agent/link/sample_queue.h"
#include "haptic_agent/link/stock_listener.h"
#include "haptic_agent/link/transport_switch.h"
#include "haptic_agent/realtime/latest_value.h"
#include "haptic_agent/servo/mapping/workspace_mapping.h"
#include "haptic_agent/servo/sample_ring.h"
#include "haptic_agent/servo/wrench_interpolator.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// Why a connection ended. After a final loss the link does not reconnect.
struct Loss {
  std::string reason;
  bool final = false;
  std::string redirect = {};  ///< address of the server that continues; empty: the same
};

/// Returns the loss for a server that declined the WebSocket with an HTTP status and body. Client
/// errors (4xx) are final, except 429.
Loss declined(const std::string& session, unsigned status, std::string_view body);

struct TrafficOptions {
  /// Out of contact, skip poses that differ imperceptibly from the last one.
  bool deadband = false;
  /// Destination of status updates. May be null.
  LatestValue<LinkStatus>* status = nullptr;
  /// Receives stock updates. If null, none are requested.
  StockListener* copy = nullptr;
  /// The box that the device reaches. Each change is sent, at most one every 100 ms. May be null.
  LatestValue<Reach>* reach = nullptr;
};

/// The protocol of the link without its sockets: decides which frame is due, handles received
/// frames, and counts both. Used on the link thread only.
class Traffic {
 public:
  /// Both references must outlive the object.
  Traffic(SampleRing& samples, LatestValue<ServerWrench>& wrenches, TrafficOptions options = {})
      : ring_(samples), wrenches_(wrenches), options_(options) {}

  /// Call when a connection was welcomed; `tool_id` is that of the hello. `server_has`: number up
  /// to which the server has this agent's samples, if it reports durable samples.
  void begin(std::uint32_t epoch, std::uint32_t tool_id, std::uint64_t now_us,
             bool udp_offered = false, std::optional<std::uint64_t> server_has = {});
  /// States whether the server accepts 'reach' messages. Call after `begin`. Then sends the newest
  /// reach.
  void offer_reach(bool taken) noexcept { reach_taken_ = reach_due_ = taken; }
  /// Counts a connection on which the server recognized the agent.
  void note_resumed() noexcept { ++report_.resumed; }
  /// Records that the user requested UDP.
  void ask_for_udp() noexcept { report_.udp.asked = true; }

  /// Requests an undo of the agent's newest stroke, or a redo of the last undone one. Discarded
  /// with the connection.
  void ask(bool undone) { asked_.push_back(undone); }
  /// Moves the samples of the ring to the queue. Returns their number.
  std::size_t collect();
  /// Returns true if every collected sample is answered and durable.
  bool settled() const noexcept { return queue_.settled() && queue_.not_durable() == 0; }
  /// Like `settled`. If all samples are answered, also hastens the next ping, whose answer states
  /// which are durable.
  bool settle(std::uint64_t now_us) noexcept;

  /// Returns the control message that must precede the next frame, such as a tool change. May be
  /// empty.
  std::string take_control(std::uint64_t now_us);
  /// Encodes the next due WebSocket frame into `frame` (kMaxClientFrameBytes). Returns its size, or
  /// 0.
  std::size_t fill(std::uint64_t now_us, std::span<std::byte> frame);
  /// Like fill, for UDP (datagram::kMaxFrameBytes).
  std::size_t fill_datagram(std::uint64_t now_us, std::span<std::byte> frame);

  /// Handle a received frame. Return the reason if the connection must end. `notice` is set to a
  /// line for the user, or left empty.
  std::optional<Loss> take_text(std::string_view text, std::string& notice);
  std::optional<Loss> take_frame(std::span<const std::byte> frame, std::uint64_t now_us);
  std::optional<Loss> take_datagram(std::span<const std::byte> frame, std::uint64_t now_us);
  /// Returns the other servers that may continue the session if the server has sent a new list.
  std::optional<std::vector<std::string>> take_servers() {
    return std::exchange(servers_, std::nullopt);
  }
  /// Returns a line for the user about UDP. Empty if there is none.
  std::string take_notice();
  /// Counters maintained by the UDP socket.
  UdpReport& udp_counts() noexcept { return report_.udp; }

  /// Returns all counters so far, including those of the queue.
  LinkReport report() const;

 private:
  void take_buttons(wire::MotionSample& sample);
  bool take_reach(std::uint64_t now_us) noexcept;
  bool holds_back(const wire::MotionSample& sample) const noexcept;
  void take_pong(const wire::Pong& pong, std::uint64_t now_us);
  void take_felt(const wire::ToolStates& states);
  void take_result(const wire::Result& result, std::uint64_t now_us);
  std::optional<Loss> take_message(const wire::Message& message, std::uint64_t now_us);
  UdpReport udp_report() const;
  void choose_transport(std::uint64_t now_us);
  void leave_udp();
  void resend_lost(std::uint64_t now_us);
  void take_gap(std::uint64_t now_us);
  void note_progress(const wire::Result& result, std::uint64_t now_us);
  wire::FrameStamp stamp(std::uint64_t sequence, std::uint64_t now_us) const noexcept {
    return {.epoch = epoch_, .sequence = sequence, .time_us = now_us};
  }

  SampleRing& ring_;
  LatestValue<ServerWrench>& wrenches_;
  TrafficOptions options_;
  SampleQueue queue_;
  /// The last queued sample, and a later one that the deadband delays.
  std::optional<wire::MotionSample> queued_;
  std::optional<wire::MotionSample> held_;
  /// The newest result reports no force and no nearby contact.
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

  TransportSwitch transport_;
  /// Number of the first sample on this connection, with the current tool, or after the last
  /// request. It must be sent over the WebSocket, in order with those messages. Once it is
  /// answered, samples may use UDP. 0: not sent yet. Empty: the message before it has not been sent
  /// yet.
  std::optional<std::uint64_t> base_ = 0;
  /// The server has answered the base sample.
  bool based_ = false;
  std::uint64_t progress_us_ = 0;
  std::uint64_t went_back_us_ = 0;
  /// Resends since the last progress. There are few, because the transport falls back after a
  /// silence.
  unsigned fruitless_resends_ = 0;
  std::uint64_t udp_rtt_us_ = 0;
  std::uint64_t newest_felt_ = 0;
  /// Requests to undo (true) or redo (false) that are not sent yet.
  std::deque<bool> asked_;
  std::uint32_t pressed_ = 0;  ///< kButtonUndo and kButtonRedo in the last sample
  /// The newest reach, and whether it must be sent.
  std::optional<Reach> device_reach_;
  bool reach_taken_ = false, reach_due_ = false;
  std::uint64_t next_reach_us_ = 0;  ///< earliest time of the next reach message on this connection
  /// Sequence of the stock frame to acknowledge.
  std::optional<std::uint64_t> ack_due_;
  std::optional<std::vector<std::string>> servers_;  ///< other ones, not taken yet
};

}  // namespace kerf::agent
