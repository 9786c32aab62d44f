// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/sheet_point.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Cosine of the angle from the mean normal up to which a sheet is considered smooth, not creased:
/// half the angle between two planes. Near this angle a wrong choice errs by 1/40 of the pitch.
constexpr double kSmoothSheetCosine = 0.995;

using Coordinates = std::array<double, 3>;

Coordinates coordinates(Vec3 v) { return {v.x, v.y, v.z}; }

/// The sum of squared distances from planes, as a function of position.
class PlaneSum {
 public:
  explicit PlaneSum(Vec3 mean) : mean_(coordinates(mean)) {}

  void add(const Crossing& c) {
    const Coordinates n = coordinates(c.normal), p = coordinates(c.point);
    const double off =
        c.weight * (n[0] * (p[0] - mean_[0]) + n[1] * (p[1] - mean_[1]) + n[2] * (p[2] - mean_[2]));
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t k = r; k < 3; ++k) a_[r][k] += c.weight * n[r] * n[k];
      b_[r] += off * n[r];
      if (std::abs(n[r]) == 1 && !c.is_guess()) {
        square_[r] += c.weight * p[r];
        squares_[r] += c.weight;
      }
    }
    pull_ += c.weight * kMeanWeight;
  }

  /// Returns the minimum, constrained to the limits.
  Coordinates least(const CellLimits& limits) {
    const Coordinates low = coordinates(limits.low), high = coordinates(limits.high);
    std::array<bool, 3> fixed{};
    Coordinates x = mean_;
    for (std::size_t r = 0; r < 3; ++r) {
      a_[r][r] += pull_;
      for (std::size_t k = 0; k < r; ++k) a_[r][k] = a_[k][r];
      fixed[r] = squares_[r] > 0;
      if (fixed[r]) x[r] = std::clamp(square_[r] / squares_[r], low[r], high[r]);
    }
    for (int round = 0; round < 4; ++round) {
      solve(fixed, x);
      std::size_t worst = 3;
      double most = 0;
      for (std::size_t r = 0; r < 3; ++r) {
        const double beyond = std::max(low[r] - x[r], x[r] - high[r]);
        if (beyond > most) {
          most = beyond;
          worst = r;
        }
      }
      if (worst == 3) break;
      x[worst] = std::clamp(x[worst], low[worst], high[worst]);
      fixed[worst] = true;
    }
    return x;
  }

 private:
  /// Solves for the coordinates that are not fixed, by Gaussian elimination. The matrix is positive
  /// definite.
  void solve(const std::array<bool, 3>& fixed, Coordinates& x) const {
    std::array<std::size_t, 3> free{};
    std::size_t count = 0;
    for (std::size_t r = 0; r < 3; ++r) {
      if (!fixed[r]) free[count++] = r;
    }
    double m[3][4] = {};
    for (std::size_t r = 0; r < count; ++r) {
      m[r][3] = b_[free[r]];
      for (std::size_t k = 0; k < count; ++k) m[r][k] = a_[free[r]][free[k]];
      for (std::size_t k = 0; k < 3; ++k) {
        if (fixed[k]) m[r][3] -= a_[free[r]][k] * (x[k] - mean_[k]);
      }
    }
    for (std::size_t r = 0; r < count; ++r) {
      for (std::size_t below = r + 1; below < count; ++below) {
        const double share = m[below][r] / m[r][r];
        for (std::size_t k = r; k < 4; ++k) m[below][k] -= share * m[r][k];
      }
    }
    for (std::size_t r = count; r-- > 0;) {
      double v = m[r][3];
      for (std::size_t k = r + 1; k < count; ++k) v -= m[r][k] * (x[free[k]] - mean_[free[k]]);
      x[free[r]] = mean_[free[r]] + v / m[r][r];
    }
  }

  Coordinates mean_, b_{}, square_{}, squares_{};
  double a_[3][3] = {};
  double pull_ = 0;
};

Vec3 clamped(Vec3 v, const CellLimits& limits) {
  return {std::clamp(v.x, limits.low.x, limits.high.x),
          std::clamp(v.y, limits.low.y, limits.high.y),
          std::clamp(v.z, limits.low.z, limits.high.z)};
}

}  // namespace

SheetPoint place_sheet(std::span<const Crossing> crossings, const CellLimits& limits) {
  Vec3 point_sum, normal_sum;
  for (const Crossing& c : crossings) {
    point_sum = point_sum + c.point;
    normal_sum = normal_sum + c.normal;
  }
  const double share = 1 / double(crossings.size());
  const Vec3 mean = point_sum * share, normal = normalized(normal_sum);
  const bool smooth = std::ranges::all_of(
      crossings, [&](const Crossing& c) { return dot(c.normal, normal) > kSmoothSheetCosine; });
  if (smooth) {
    double off = 0;
    for (const Crossing& c : crossings) off += dot(c.normal, c.point - mean);
    return {clamped(mean + normal * (0.5 * share * off), limits), false};
  }
  PlaneSum planes(mean);
  for (const Crossing& c : crossings) planes.add(c);
  const Coordinates x = planes.least(limits);
  return {{x[0], x[1], x[2]}, true};
}

}  // namespace kerf
