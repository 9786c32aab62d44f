// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/wrench_limiter.h"

#include <algorithm>

namespace kerf::agent {
namespace {

/// Shortens `v` to the length `most`. Returns exactly `v` if it is not longer.
Vec3 shortened_to(double most, Vec3 v, bool& shortened) noexcept {
  const double current = length(v);
  if (current <= most) return v;
  shortened = true;
  return v * (most / current);
}

/// Returns the vector nearest to `target` that `current` may become in one step. It may fall to any
/// fraction of itself at once, and move by `rise` in any direction from there, so a reversal passes
/// through zero immediately.
Vec3 slew(Vec3 current, Vec3 target, double rise, bool& slewed) noexcept {
  const double square = dot(current, current);
  const double keep = square > 0 ? std::clamp(dot(target, current) / square, 0.0, 1.0) : 0.0;
  const Vec3 base = current * keep;
  return base + shortened_to(rise, target - base, slewed);
}

}  // namespace

WrenchLimits within(const DeviceCapabilities& device, WrenchLimits limits) {
  if (device.max_force_n > 0) {
    limits.force_n = std::min(limits.force_n, kDeviceShare * device.max_force_n);
  }
  if (device.max_torque_nmm > 0) {
    limits.torque_nmm = std::min(limits.torque_nmm, kDeviceShare * device.max_torque_nmm);
  }
  return limits;
}

Wrench WrenchLimiter::limit(const Wrench& requested, double dt_s) noexcept {
  if (!is_finite(requested)) {
    ++not_finite_;
    output_ = {};
    return output_;
  }
  const double share = share_within({limits_.force_n, limits_.torque_nmm}, requested);
  bool slewed = false;
  output_.force_n =
      slew(output_.force_n, requested.force_n * share, limits_.force_rise_n_per_s * dt_s, slewed);
  output_.torque_nmm = slew(output_.torque_nmm, requested.torque_nmm * share,
                            limits_.torque_rise_nmm_per_s * dt_s, slewed);
  saturated_ += share < 1 ? 1 : 0;
  slewed_ += slewed ? 1 : 0;
  return output_;
}

Wrench WrenchLimiter::shorten(double share) noexcept { return output_ = output_ * share; }

}  // namespace kerf::agent
