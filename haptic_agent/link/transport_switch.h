// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerf::agent {

/// Chooses the transport for the samples of a connection: the WebSocket until an answer has arrived
/// over UDP, and again when UDP goes silent. All times are in us on one clock.
class TransportSwitch {
 public:
  static constexpr std::uint64_t kProbeEveryUs = 100'000;
  /// Number of unanswered probes after which UDP counts as blocked, until the next attempt.
  static constexpr int kProbes = 10;
  /// UDP counts as silent after no progress for this time plus a round trip.
  static constexpr std::uint64_t kSilenceUs = 300'000;
  /// Pause before UDP is probed again. It doubles each time and is reset after UDP has been in use
  /// for kGoodUs.
  static constexpr std::uint64_t kFirstPauseUs = 1'000'000;
  static constexpr std::uint64_t kLongestPauseUs = 60'000'000;
  static constexpr std::uint64_t kGoodUs = 10'000'000;

  /// Call when a WebSocket has opened, with or without an offer of UDP.
  void begin(bool offered, std::uint64_t now_us) noexcept;
  /// Call when an authentic datagram has arrived.
  void note_datagram() noexcept { answered_ = probing_; }
  /// Returns true if a ping must be sent over UDP now, and schedules the next one.
  bool probe_due(std::uint64_t now_us) noexcept;
  /// Updates the choice. Call periodically. `ready`: the server can accept samples over UDP;
  /// `stuck_us`: time since the last progress while samples are unanswered. Returns true if the
  /// samples move from UDP to the WebSocket.
  bool update(std::uint64_t now_us, bool ready, std::uint64_t stuck_us, std::uint64_t rtt_us);
  /// Uses the WebSocket until `ready` is set again. Does not count as a failure of UDP.
  void leave() noexcept { over_udp_ = false; }

  bool offered() const noexcept { return offered_; }
  bool over_udp() const noexcept { return over_udp_; }
  std::uint64_t taken_over() const noexcept { return taken_over_; }
  std::uint64_t fell_back() const noexcept { return fell_back_; }
  /// Returns one line for the user, each kind once. May be empty.
  std::string take_notice();

 private:
  void pause(std::uint64_t now_us) noexcept;

  bool offered_ = false, over_udp_ = false;
  /// Probes are being sent; false during a pause.
  bool probing_ = false;
  /// A datagram has arrived since the first probe.
  bool answered_ = false;
  int probes_ = 0;
  std::uint64_t next_probe_us_ = 0, since_us_ = 0, pause_us_ = kFirstPauseUs;
  std::uint64_t taken_over_ = 0, fell_back_ = 0;
  bool notified_blocked_ = false, notified_silent_ = false;
  std::string notice_;
};

}  // namespace kerf::agent
