// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "kernel/math/wrench.h"

namespace kerf::agent {

/// Returns the share of the computed wrench, 0 to 1, that the felt one contains: the factor f that
/// minimizes |felt - f computed|², torques divided by `lever_mm`. 1 if nothing is computed, 0 if
/// the computed wrench is not finite.
inline double felt_share(const Wrench& felt, const Wrench& computed, double lever_mm) noexcept {
  const double per_mm2 = 1 / (lever_mm * lever_mm);
  const auto product = [per_mm2](const Wrench& a, const Wrench& b) {
    return dot(a.force_n, b.force_n) + dot(a.torque_nmm, b.torque_nmm) * per_mm2;
  };
  const double square = product(computed, computed);
  if (!std::isfinite(square)) return 0;
  return square > 0 ? std::clamp(product(felt, computed) / square, 0.0, 1.0) : 1.0;
}

/// Sums over ticks for one quantity, force (N) or torque (N·mm): computed, felt, and the difference
/// of the two vectors.
class FeltSums {
 public:
  void add(Vec3 felt, Vec3 computed) noexcept {
    const Vec3 error = felt - computed;
    felt_ += length(felt);
    computed_ += length(computed);
    square_ += dot(computed, computed);
    error_square_ += dot(error, error);
    felt_peak_ = std::max(felt_peak_, length(felt));
    computed_peak_ = std::max(computed_peak_, length(computed));
    ++ticks_;
  }

  double felt_mean() const noexcept { return ticks_ > 0 ? felt_ / ticks() : 0; }
  double computed_mean() const noexcept { return ticks_ > 0 ? computed_ / ticks() : 0; }
  double felt_peak() const noexcept { return felt_peak_; }
  double computed_peak() const noexcept { return computed_peak_; }
  /// Root mean square of the difference over that of the computed quantity.
  double error() const noexcept { return square_ > 0 ? std::sqrt(error_square_ / square_) : 0; }

 private:
  double ticks() const noexcept { return static_cast<double>(ticks_); }

  std::uint64_t ticks_ = 0;
  double felt_ = 0, computed_ = 0, square_ = 0, error_square_ = 0;
  double felt_peak_ = 0, computed_peak_ = 0;
};

/// Felt and computed wrench, over the ticks in which the force was on and the session computed one.
struct FeltReport {
  std::uint64_t ticks = 0;
  /// Ticks in which less than kWhole of the computed wrench was felt, for any reason: limits, their
  /// rise, ramp, fading, the energy tank.
  std::uint64_t reduced_ticks = 0;
  FeltSums force{}, torque{};

  static constexpr double kWhole = 0.95;

  void add(const Wrench& felt, const Wrench& computed, double share) noexcept {
    if (!is_finite(computed) || !(dot(computed.force_n, computed.force_n) > 0)) return;
    ++ticks;
    reduced_ticks += share < kWhole ? 1 : 0;
    force.add(felt.force_n, computed.force_n);
    torque.add(felt.torque_nmm, computed.torque_nmm);
  }
};

}  // namespace kerf::agent
