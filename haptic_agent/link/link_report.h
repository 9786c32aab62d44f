// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "haptic_agent/link/clock_sync.h"
#include "haptic_agent/servo/histogram.h"

namespace kerf::agent {

struct ServerComplaint {
  std::uint64_t count = 0;
  std::string first_reason;
};

/// What the UDP lane has seen; all zero where it was not asked for.
struct UdpReport {
  bool asked = false;
  bool offered = false;
  /// UDP carries the samples now, or did so at the end.
  bool carries = false;
  /// How often UDP took the samples over from the WebSocket, and how often it gave them back
  /// because it had gone silent.
  std::uint64_t taken_over = 0;
  std::uint64_t fell_back = 0;
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  /// Sent by the server and not received; by its own counters.
  std::uint64_t lost = 0;
  /// Came, but with no true seal, or twice.
  std::uint64_t dropped = 0;
  /// Samples that went over UDP first.
  std::uint64_t samples = 0;
  /// Samples that went along with new ones, in case the datagrams before were lost.
  std::uint64_t repeated = 0;
  /// Answers that told of a gap.
  std::uint64_t gaps = 0;
};

/// How the link is doing now, for whoever looks on.
struct LinkStatus {
  std::uint64_t connections = 0;
  std::uint64_t samples_sent = 0;
  std::uint64_t results = 0;
  std::uint64_t rtt_us = 0;  ///< of the last ping
  std::int64_t clock_offset_us = 0;
  UdpReport udp{};
};

/// What the link has seen; complete when it has stopped.
struct LinkReport {
  std::uint64_t connections = 0;
  std::uint64_t samples_sent = 0;
  std::uint64_t messages_sent = 0;
  std::uint64_t resent = 0;
  std::uint64_t merged_air = 0;
  std::uint64_t merged_cuts = 0;
  std::uint64_t thinned_cuts = 0;
  std::uint64_t forgotten = 0;
  /// Left out of contact, because a hand would not feel the difference.
  std::uint64_t held_back = 0;
  std::uint64_t unanswered = 0;
  std::uint64_t results = 0;
  std::uint64_t rejected_results = 0;
  /// Answers that were not newer than one that had come before.
  std::uint64_t old_results = 0;
  std::uint64_t bad_frames = 0;
  std::uint64_t motions_in_session = 0;
  double removed_mm3 = 0;
  double max_server_force_n = 0;
  UdpReport udp;
  ClockSync clock;
  /// From when a pose was measured to when its answer was here.
  Histogram answer_us;
  Histogram turnaround_us;
  std::map<std::string, ServerComplaint> complaints;
  /// Why the link gave up; empty if it did not.
  std::string failure;
};

}  // namespace kerf::agent
