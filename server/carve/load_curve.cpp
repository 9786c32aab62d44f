// SPDX-License-Identifier: Apache-2.0
#include "server/carve/load_curve.h"

#include <algorithm>

namespace kerf {

void LoadCurve::add(const ProgramMotion& motion, double force_n, double removed_mm3) {
  const double begin_s = end_s_;
  end_s_ += motion.duration_s;
  while (end_s_ > interval_s_ * static_cast<double>(kIntervalsMax)) halve();
  const auto first = static_cast<std::size_t>(begin_s / interval_s_);
  const auto last = std::min(static_cast<std::size_t>(end_s_ / interval_s_), kIntervalsMax - 1);
  while (intervals_.size() <= last)
    intervals_.push_back({.file = motion.file, .line = motion.line});
  for (std::size_t n = first; n <= last; ++n) {
    const double from_s = std::max(begin_s, interval_s_ * static_cast<double>(n));
    const double to_s = n == last ? end_s_ : interval_s_ * static_cast<double>(n + 1);
    LoadInterval& interval = intervals_[n];
    if (motion.duration_s > 0)
      interval.removed_mm3 += removed_mm3 * std::max(0.0, to_s - from_s) / motion.duration_s;
    if (force_n <= interval.force_n) continue;
    interval.force_n = force_n;
    interval.file = motion.file;
    interval.line = motion.line;
  }
}

void LoadCurve::halve() {
  interval_s_ *= 2;
  for (std::size_t n = 0; 2 * n < intervals_.size(); ++n) {
    LoadInterval one = intervals_[2 * n];
    if (2 * n + 1 < intervals_.size()) {
      const LoadInterval& next = intervals_[2 * n + 1];
      one.removed_mm3 += next.removed_mm3;
      if (next.force_n > one.force_n) {
        one.force_n = next.force_n;
        one.file = next.file;
        one.line = next.line;
      }
    }
    intervals_[n] = one;
  }
  intervals_.resize((intervals_.size() + 1) / 2);
}

}  // namespace kerf
