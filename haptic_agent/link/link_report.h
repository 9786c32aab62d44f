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

/// How the link is doing now, for whoever looks on.
struct LinkStatus {
  std::uint64_t connections = 0;
  std::uint64_t samples_sent = 0;
  std::uint64_t results = 0;
  std::uint64_t rtt_us = 0;  ///< of the last ping
  std::int64_t clock_offset_us = 0;
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
  std::uint64_t refused_results = 0;
  std::uint64_t bad_frames = 0;
  std::uint64_t motions_in_session = 0;
  double removed_mm3 = 0;
  double max_server_force_n = 0;
  ClockSync clock;
  /// From when a pose was measured to when its answer was here.
  Histogram answer_us;
  Histogram turnaround_us;
  std::map<std::string, ServerComplaint> complaints;
  /// Why the link gave up; empty if it did not.
  std::string failure;
};

}  // namespace kerf::agent
