// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "haptic_agent/force_reason.h"
#include "haptic_agent/force_watch.h"
#include "haptic_agent/servo/flight_recorder.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

/// Returns the last ticks before a trip as CSV: one comment line with the code, a header, and one
/// line per tick.
std::string trip_csv(const FlightLog& log);

/// Notifies the user on standard error, from an ordinary thread: of trips at once, and of other
/// reasons why there is no force (ForceWatch). Appends the ticks before a trip to a file if one is
/// given.
class TripWriter {
 public:
  /// `cycle` and `reasons` must outlive the object. `file` may be empty.
  TripWriter(ServoCycle& cycle, const ForceReasons& reasons, std::string file);
  ~TripWriter();
  TripWriter(const TripWriter&) = delete;
  TripWriter& operator=(const TripWriter&) = delete;

 private:
  void write_one();
  void tell(std::uint64_t now_us);

  const ServoCycle& cycle_;
  FlightRecorder& recorder_;
  const ForceReasons& reasons_;
  ForceWatch watch_;
  std::string file_;
  std::jthread thread_;
};

}  // namespace kerf::agent
