// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kernel/force/cut_sum.h"
#include "kernel/force/milling_sum.h"

namespace kerf {

/// Distributes the sums of a cut over the travel that follows it. Volume removed at a point of the
/// path becomes due over the next two widths, according to the kernel box * box of that width. The
/// mean delay is one width, and any input that is periodic in the width, or in an integer fraction
/// of it, is delivered as a constant. The output depends on travel only, not on time or ticks, and
/// is complete: delivered + pending = removed, to rounding. Derivation: kernel/force/README.md.
/// `Sum` is CutSum or MillingSum.
template <class Sum>
class TravelQueueOf {
 public:
  explicit TravelQueueOf(double width_mm) : width_mm_(width_mm), head_left_mm_(bin_mm()) {}

  double width_mm() const { return width_mm_; }
  /// Advances by `path_mm` of travel and returns the amounts that became due.
  Sum advance(double path_mm);
  /// Adds amounts removed evenly over the last `path_mm` of travel, and returns their part that is
  /// already due. Later advances deliver the rest.
  Sum take(const Sum& removed, double path_mm);

  /// Turns the pending amounts with the tool.
  void turn(const Turn& turn);

  /// Returns the amounts due next, per mm of travel: the engagement of a tool at rest.
  Sum due_per_mm() const;
  /// Returns the amounts not yet delivered.
  Sum pending() const;
  /// Returns the volume not yet delivered.
  double pending_mm3() const;

 private:
  static constexpr int kBinsPerWidth = 8;
  /// Enough for two widths when part of the first bin has passed.
  static constexpr int kBins = 2 * kBinsPerWidth + 1;

  double bin_mm() const { return width_mm_ / kBinsPerWidth; }
  Sum& bin(int k) { return bins_[std::size_t((head_ + k) % kBins)]; }
  const Sum& bin(int k) const { return bins_[std::size_t((head_ + k) % kBins)]; }

  double width_mm_;
  double head_left_mm_;  ///< remaining length of the first bin
  int head_ = 0;
  bool empty_ = true;
  std::array<Sum, kBins> bins_;  ///< amounts due, by travel ahead; a ring buffer
};

extern template class TravelQueueOf<CutSum>;
extern template class TravelQueueOf<MillingSum>;
using TravelQueue = TravelQueueOf<CutSum>;

}  // namespace kerf
