// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "haptic_agent/guides/guide_model.h"
#include "haptic_agent/link/server_link.h"
#include "haptic_agent/realtime/realtime_thread.h"
#include "haptic_agent/record/recorder.h"
#include "haptic_agent/replica/replica_thread.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "haptic_agent/servo/servo_loop.h"
#include "haptic_agent/study/study.h"

namespace kerf::agent {

/// Counters and measurements of a run.
struct Summary {
  Welcome welcome;
  std::string device;
  WorkspaceMapping mapping;
  RealtimeReport realtime;
  CycleStats cycles;
  ServoReport servo;
  std::uint64_t saturated_ticks = 0;
  std::uint64_t slewed_ticks = 0;
  std::uint64_t not_finite_wrenches = 0;
  /// Maximum deviation of the simulated hand from its path, or 0 for other devices.
  double max_deviation_mm = 0;
  std::uint64_t watchdog_stops = 0;
  std::uint64_t trips = 0;
  TripCode last_trip = TripCode::kNone;
  std::uint64_t degraded_ticks = 0;
  /// Why there was no force at the end, or less than computed, and its sentence.
  NoForce no_force = NoForce::kNone;
  std::string no_force_text;
  std::uint64_t projected_wrenches = 0;
  /// Net work done on the user, and its maximum over any interval.
  double given_mj = 0;
  double most_returned_mj = 0;
  LinkReport link;
  ReplicaReport copy;
  std::vector<GuideUse> guides;
  RecordReport record;
  StudyReport study;
};

/// Whether the server answered everything, and any recording and study were written. Otherwise the
/// agent ends with an error.
bool succeeded(const Summary& summary);

/// Prints the summary as text.
void print_summary(std::ostream& out, const Summary& summary);
/// Returns the summary as one JSON object, followed by a line break.
std::string summary_json(const Summary& summary);

}  // namespace kerf::agent
