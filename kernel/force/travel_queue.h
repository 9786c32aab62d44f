// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kernel/force/cut_sum.h"

namespace kerf {

/// Distributes the sums of a cut over the travel that follows it. Volume removed at a point of the
/// path becomes due over the next two widths, according to the kernel box * box of that width. The
/// mean delay is one width, and any input that is periodic in the width, or in an integer fraction
/// of it, is delivered as a constant. The output depends on travel only, not on time or ticks, and
/// is complete: delivered + pending = removed, to rounding. Derivation: kernel/force/README.md.
class TravelQueue {
 public:
  explicit TravelQueue(double width_mm) : width_mm_(width_mm), head_left_mm_(bin_mm()) {}

  /// Advances by `path_mm` of travel and returns what became due.
  CutSum advance(double path_mm);
  /// Adds what was removed evenly over the last `path_mm` of travel, and returns the part of it
  /// that is due already. Later advances deliver the rest.
  CutSum take(const CutSum& removed, double path_mm);

  /// Turns what is pending with the tool.
  void turn(const Turn& turn);

  /// Returns what becomes due next, per mm of travel: the engagement of a tool at rest.
  CutSum due_per_mm() const;
  /// Returns what is not yet delivered.
  CutSum pending() const;

 private:
  static constexpr int kBinsPerWidth = 8;
  /// Enough for two widths when part of the first bin has passed.
  static constexpr int kBins = 2 * kBinsPerWidth + 1;

  double bin_mm() const { return width_mm_ / kBinsPerWidth; }
  CutSum& bin(int k) { return bins_[std::size_t((head_ + k) % kBins)]; }
  const CutSum& bin(int k) const { return bins_[std::size_t((head_ + k) % kBins)]; }

  double width_mm_;
  double head_left_mm_;  ///< remaining length of the first bin
  int head_ = 0;
  bool empty_ = true;
  std::array<CutSum, kBins> bins_;  ///< amounts due, by travel ahead; a ring buffer
};

}  // namespace kerf
