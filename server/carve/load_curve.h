// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/formats/program.h"

namespace kerf {

/// The load of the cutter in one interval of a program's time.
struct LoadInterval {
  double force_n = 0;                ///< greatest
  double removed_mm3 = 0;            ///< without imprints
  std::uint32_t file = 0, line = 0;  ///< of the motion with the greatest force, or else the first
};

/// Collects force and removal along the time of a program in a bounded number of intervals of equal
/// length. The volume of a motion is spread evenly over its time.
class LoadCurve {
 public:
  static constexpr std::size_t kIntervalsMax = 600;

  /// Adds the next motion of the program.
  void add(const ProgramMotion& motion, double force_n, double removed_mm3);
  /// Returns the intervals up to the present time.
  const std::vector<LoadInterval>& intervals() const { return intervals_; }
  /// Returns the length of an interval, s.
  double interval_s() const { return interval_s_; }
  /// Returns the time of all motions, s.
  double end_s() const { return end_s_; }

 private:
  void halve();

  std::vector<LoadInterval> intervals_;
  double interval_s_ = 1e-3;
  double end_s_ = 0;
};

}  // namespace kerf
