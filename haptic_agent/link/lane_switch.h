// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerf::agent {

/// Which lane carries the samples of a connection: the WebSocket, until an answer has proven that
/// UDP gets through, and again when UDP has gone silent. All times in us of one clock.
class LaneSwitch {
 public:
  static constexpr std::uint64_t kProbeEveryUs = 100'000;
  /// So many probes without an answer, and UDP is taken for blocked, for a while.
  static constexpr int kProbes = 10;
  /// UDP is left when nothing has moved on for this long and a round trip.
  static constexpr std::uint64_t kSilenceUs = 300'000;
  /// The pause before UDP is tried again; doubled each time, and short again after UDP has carried
  /// for kGoodUs.
  static constexpr std::uint64_t kFirstPauseUs = 1'000'000;
  static constexpr std::uint64_t kLongestPauseUs = 60'000'000;
  static constexpr std::uint64_t kGoodUs = 10'000'000;

  /// A new WebSocket, with a UDP lane beside it or without.
  void begin(bool offered, std::uint64_t now_us) noexcept;
  /// A datagram with a true seal has come.
  void heard() noexcept { answered_ = trying_; }
  /// True if a ping is to go out over UDP now; the next one is due later.
  bool probe_due(std::uint64_t now_us) noexcept;
  /// What is to be known once in a while: `ready`: UDP may carry; `stuck_us`: for how long
  /// something has been unanswered without anything moving on. True if the samples have left UDP.
  bool update(std::uint64_t now_us, bool ready, std::uint64_t stuck_us, std::uint64_t rtt_us);
  /// The WebSocket carries until `ready` is seen again; UDP is not to blame.
  void leave() noexcept { over_udp_ = false; }

  bool offered() const noexcept { return offered_; }
  bool over_udp() const noexcept { return over_udp_; }
  std::uint64_t taken_over() const noexcept { return taken_over_; }
  std::uint64_t fell_back() const noexcept { return fell_back_; }
  /// One line for the user, each kind once; empty if there is none.
  std::string take_notice();

 private:
  void pause(std::uint64_t now_us) noexcept;

  bool offered_ = false, over_udp_ = false;
  /// Probes go out; not during a pause.
  bool trying_ = false;
  /// One of them, or what came after it, was answered.
  bool answered_ = false;
  int probes_ = 0;
  std::uint64_t next_probe_us_ = 0, since_us_ = 0, pause_us_ = kFirstPauseUs;
  std::uint64_t taken_over_ = 0, fell_back_ = 0;
  bool said_blocked_ = false, said_silent_ = false;
  std::string notice_;
};

}  // namespace kerf::agent
