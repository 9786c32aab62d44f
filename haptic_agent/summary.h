// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ostream>
#include <string>

#include "haptic_agent/link/server_link.h"
#include "haptic_agent/replica/replica_thread.h"
#include "haptic_agent/servo/realtime.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "haptic_agent/servo/servo_loop.h"

namespace kerf::agent {

/// Everything a run has to tell.
struct Summary {
  Welcome welcome;
  std::string device;
  RealtimeReport realtime;
  CycleStats cycles;
  ServoReport servo;
  std::uint64_t saturated_ticks = 0;
  std::uint64_t slewed_ticks = 0;
  std::uint64_t not_finite_wrenches = 0;
  /// How far the simulated hand was pushed off its path; 0 for other devices.
  double max_deviation_mm = 0;
  std::uint64_t watchdog_stops = 0;
  std::uint64_t trips = 0;
  TripCode last_trip = TripCode::kNone;
  std::uint64_t degraded_ticks = 0;
  std::uint64_t projected_wrenches = 0;
  /// Net work into the hand, and the most over any interval.
  double given_mj = 0;
  double most_returned_mj = 0;
  LinkReport link;
  ReplicaReport copy;
};

/// For a person: a few lines.
void print_summary(std::ostream& out, const Summary& summary);
/// For a program: one JSON object, with a line break at its end.
std::string summary_json(const Summary& summary);

}  // namespace kerf::agent
