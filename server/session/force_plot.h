// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <vector>

#include "kernel/math/wrench.h"

namespace kerf {

/// A motion as a plot shows it.
struct PlottedMotion {
  std::uint64_t record = 0;
  std::int64_t wall_ms = 0;
  double end_s = 0;  ///< on a clock that runs while the tool moves
  double removed_mm3 = 0;
  Vec3 tip_mm;  ///< where the motion ends
  Wrench wrench;
};

/// Decimates the forces of motions for a plot: minimum, mean and maximum magnitude, removed volume
/// and the greatest wrench with its place, for each of a number of equal spans of records.
class ForcePlot {
 public:
  /// Divides the records `first` to `last` into at most `points` spans. Empty if `first` > `last`.
  ForcePlot(std::uint64_t first, std::uint64_t last, std::size_t points);
  /// Adds a motion. Record numbers must ascend. Motions outside the plot are ignored.
  void add(const PlottedMotion& motion);
  /// Writes an object whose arrays have one value for each span with a motion:
  /// {"span":N,"first":[…],"last":[…],"time_ms":[…],"motions":[…],"end_s":[…],"removed_mm3":[…],
  ///  "force_n":{"min":[…],"mean":[…],"max":[…]},"torque_nmm":{…},
  ///  "peak":{"tip_mm":[[x,y,z],…],"force_n":[…],"torque_nmm":[…]}}
  /// `span` is the number of records of a span. `first` and `last` are the records of its first and
  /// last motion. `time_ms` is when the first one was recorded, `end_s` when the last one ends.
  /// Means are over the motions. `peak` is the motion with the greatest force, to 6 digits.
  void write(std::ostream& out) const;

 private:
  struct Range {
    double min = 0, sum = 0, max = 0;
    void add(double value, bool is_first);
  };
  struct Point {
    std::uint64_t span = 0, first = 0, last = 0, motions = 0;
    std::int64_t time_ms = 0;
    double end_s = 0, removed_mm3 = 0;
    Range force_n{}, torque_nmm{};
    Vec3 peak_tip_mm{};
    Wrench peak{};
  };
  std::uint64_t first_, last_, span_ = 1;
  std::vector<Point> points_;
};

}  // namespace kerf
