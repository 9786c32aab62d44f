// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "haptic_agent/link/clock_sync.h"
#include "haptic_agent/realtime/histogram.h"

namespace kerf::agent {

/// Errors with one code that the server has sent.
struct ServerComplaint {
  std::uint64_t count = 0;
  std::string first_reason;
};

/// Counters of the UDP transport. All zero if it was not requested.
struct UdpReport {
  bool asked = false;
  bool offered = false;
  /// Samples are sent over UDP now, or were at the end.
  bool carries = false;
  /// Number of switches from the WebSocket to UDP, and back because UDP went silent.
  std::uint64_t taken_over = 0;
  std::uint64_t fell_back = 0;
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  /// Sent by the server and not received, from the counters in its datagrams.
  std::uint64_t lost = 0;
  /// Received, but duplicate or not authentic.
  std::uint64_t dropped = 0;
  /// Samples that were first sent over UDP.
  std::uint64_t samples = 0;
  /// Unanswered samples repeated along with new ones, in case earlier datagrams were lost.
  std::uint64_t repeated = 0;
  /// Answers that reported a gap.
  std::uint64_t gaps = 0;
};

/// Current state of the link, for the terminal view.
struct LinkStatus {
  std::uint64_t connections = 0;
  std::uint64_t samples_sent = 0;
  std::uint64_t results = 0;
  std::uint64_t rtt_us = 0;  ///< from the last ping
  std::int64_t clock_offset_us = 0;
  UdpReport udp{};
};

/// Counters of the link; complete after it has stopped.
struct LinkReport {
  std::uint64_t connections = 0;
  std::uint64_t samples_sent = 0;
  std::uint64_t messages_sent = 0;
  std::uint64_t resent = 0;
  std::uint64_t merged_air = 0;
  std::uint64_t merged_cuts = 0;
  std::uint64_t thinned_cuts = 0;
  std::uint64_t forgotten = 0;
  /// Poses out of contact that the deadband dropped.
  std::uint64_t held_back = 0;
  std::uint64_t unanswered = 0;
  /// Connections on which the server recognized the agent by its token.
  std::uint64_t resumed = 0;
  /// Answered samples that were not durable at the end, and those that were dropped before.
  std::uint64_t not_durable = 0;
  std::uint64_t given_up = 0;
  std::uint64_t results = 0;
  std::uint64_t rejected_results = 0;
  /// Answers that were not newer than an earlier one.
  std::uint64_t old_results = 0;
  std::uint64_t bad_frames = 0;
  std::uint64_t motions_in_session = 0;
  double removed_mm3 = 0;
  /// Results of motions that began inside stock: the imprint gave no force.
  std::uint64_t imprint_results = 0;
  double max_server_force_n = 0;
  UdpReport udp;
  ClockSync clock;
  /// Time from the measurement of a pose to the arrival of its answer.
  Histogram answer_us;
  Histogram turnaround_us;
  std::map<std::string, ServerComplaint> complaints;
  /// Why the link has failed. Empty if it has not failed.
  std::string failure;
};

}  // namespace kerf::agent
