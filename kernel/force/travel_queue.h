// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kernel/force/cut_sum.h"

namespace kerf {

/// Delivers what a cut adds up to over the travel that follows it. What is removed at one place of
/// the way falls due over the next two widths, by the kernel box * box of that width: the mean
/// delay is one width, and anything that repeats every width, or every part of one, comes out
/// constant. Everything is a function of the way alone, so ticks of any length give the same, and
/// all of it is delivered: what went in is what came out and what is pending, to rounding.
class TravelQueue {
 public:
  explicit TravelQueue(double width_mm) : width_mm_(width_mm), head_left_mm_(bin_mm()) {}

  /// What earlier passes left and the next `path_mm` of the way make due.
  CutSum advance(double path_mm);
  /// Takes what was removed evenly over the `path_mm` that lie behind, and gives what of it is due
  /// already; the rest is left to later advances.
  CutSum take(const CutSum& removed, double path_mm);

  /// What falls due next, per mm of the way: the engagement of a tool that rests here.
  CutSum due_per_mm() const;
  double pending_mm3() const;

 private:
  static constexpr int kBinsPerWidth = 8;
  /// Two widths, whatever part of the first bin is gone.
  static constexpr int kBins = 2 * kBinsPerWidth + 1;

  double bin_mm() const { return width_mm_ / kBinsPerWidth; }
  CutSum& bin(int k) { return bins_[std::size_t((head_ + k) % kBins)]; }
  const CutSum& bin(int k) const { return bins_[std::size_t((head_ + k) % kBins)]; }

  double width_mm_;
  double head_left_mm_;  ///< of the first bin
  int head_ = 0;
  bool empty_ = true;
  std::array<CutSum, kBins> bins_;  ///< what falls due, by the way ahead; a ring
};

}  // namespace kerf
