// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/wrench_limiter.h"

#include <algorithm>

namespace kerf::agent {
namespace {

/// `v` shortened to `most`; exactly `v` if it is not longer.
Vec3 shorten(Vec3 v, double most, bool& shortened) noexcept {
  const double is = length(v);
  if (is <= most) return v;
  shortened = true;
  return v * (most / is);
}

/// The vector nearest to `wanted` among those that `shown` may become in one step: it may fall to
/// any part of itself at once, and from there move by `rise` in any direction. So a reversal passes
/// through zero instead of being halted on the wrong side.
Vec3 slew(Vec3 shown, Vec3 wanted, double rise, bool& slewed) noexcept {
  const double square = dot(shown, shown);
  const double keep = square > 0 ? std::clamp(dot(wanted, shown) / square, 0.0, 1.0) : 0.0;
  const Vec3 base = shown * keep;
  return base + shorten(wanted - base, rise, slewed);
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

Wrench WrenchLimiter::limit(const Wrench& wanted, double dt_s) noexcept {
  if (!is_finite(wanted)) {
    ++not_finite_;
    shown_ = {};
    return shown_;
  }
  bool saturated = false;
  bool slewed = false;
  const Vec3 force_n = shorten(wanted.force_n, limits_.force_n, saturated);
  const Vec3 torque_nmm = shorten(wanted.torque_nmm, limits_.torque_nmm, saturated);
  shown_.force_n = slew(shown_.force_n, force_n, limits_.force_rise_n_per_s * dt_s, slewed);
  shown_.torque_nmm =
      slew(shown_.torque_nmm, torque_nmm, limits_.torque_rise_nmm_per_s * dt_s, slewed);
  saturated_ += saturated ? 1 : 0;
  slewed_ += slewed ? 1 : 0;
  return shown_;
}

Wrench WrenchLimiter::fit(const Wrench& wanted) noexcept {
  double share = 1;
  const auto most_share = [&share](double is, double most) {
    if (is > most) share = std::min(share, most / is);
  };
  most_share(length(wanted.force_n), limits_.force_n);
  most_share(length(wanted.torque_nmm), limits_.torque_nmm);
  shown_ = {.force_n = wanted.force_n * share, .torque_nmm = wanted.torque_nmm * share};
  return shown_;
}

}  // namespace kerf::agent
