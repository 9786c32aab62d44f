// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "haptic_agent/servo/flight_recorder.h"

namespace kerf::agent {

/// The last ticks before a trip as a table: one comment line with the code, a header, a line a
/// tick.
std::string trip_csv(const FlightLog& log);

/// Waits on an ordinary thread for trips and writes each down: its code to standard error, its
/// ticks behind those of earlier trips into a file, or to standard error as well where there is
/// none.
class TripWriter {
 public:
  /// `recorder` must outlive it. `file` may be empty.
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
