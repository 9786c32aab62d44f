// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <string_view>
#include <thread>

#include "haptic_agent/servo/flight_recorder.h"

namespace kerf::agent {

/// Returns the last ticks before a trip as CSV: one comment line with the code, a header, and one
/// line per tick.
std::string trip_csv(const FlightLog& log);

/// Returns what happened, and what the user may do about it; a sentence without its full stop.
std::string_view trip_reason(TripCode code);

/// Logs trips from an ordinary thread: the reason to standard error, the ticks appended to a file
/// if one is given.
class TripWriter {
 public:
  /// `recorder` must outlive the object. `file` may be empty.
  TripWriter(FlightRecorder& recorder, std::string file);
  ~TripWriter();
  TripWriter(const TripWriter&) = delete;
  TripWriter& operator=(const TripWriter&) = delete;

 private:
  void write_one();

  FlightRecorder& recorder_;
  std::string file_;
  std::jthread thread_;
};

}  // namespace kerf::agent
