// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "haptic_agent/servo/flight_recorder.h"

namespace kerf::agent {

/// Returns the last ticks before a trip as CSV: one comment line with the code, a header, and one
/// line per tick.
std::string trip_csv(const FlightLog& log);

/// Logs trips from an ordinary thread: the code to standard error, the ticks appended to a file, or
/// to standard error as well if no file is given.
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
