// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/wrench_interpolator.h"

#include <algorithm>

namespace kerf::agent {

void WrenchInterpolator::take(const ServerWrench& next, std::uint64_t now_us) noexcept {
  // Start at the current output instead of the previous wrench, which is continuous even if an
  // answer arrives before the previous one was reached. With regular answers both are equal.
  from_ = at(now_us);
  const std::uint64_t gap_us =
      has_ && next.arrival_us > newest_.arrival_us ? next.arrival_us - newest_.arrival_us : 0;
  span_us_ = has_ ? std::clamp(gap_us, kShortestUs, kLongestUs) : kLongestUs;
  newest_ = next;
  start_us_ = now_us;
  has_ = true;
}

Wrench WrenchInterpolator::at(std::uint64_t now_us) const noexcept {
  if (!has_) return {};
  const std::uint64_t passed_us = now_us > start_us_ ? now_us - start_us_ : 0;
  if (passed_us >= span_us_) return newest_.wrench;
  const double part = static_cast<double>(passed_us) / static_cast<double>(span_us_);
  const Wrench& to = newest_.wrench;
  return {.force_n = from_.force_n + (to.force_n - from_.force_n) * part,
          .torque_nmm = from_.torque_nmm + (to.torque_nmm - from_.torque_nmm) * part};
}

}  // namespace kerf::agent
