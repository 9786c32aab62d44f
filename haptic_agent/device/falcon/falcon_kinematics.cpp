// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/falcon/falcon_kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kerf::agent::falcon {
namespace {

// Notation of R. E. Stamper, "A three degree of freedom parallel manipulator with only
// translational degrees of freedom" (1997). The lengths, mm, are libnifalcon's measurements.
constexpr double kA = 60.0;
constexpr double kB = 102.5;
constexpr double kC = 14.0;
constexpr double kD = 11.25;
constexpr double kE = 11.25;
constexpr double kF = -25.0;
constexpr double kR = 37.233758;
constexpr double kS = -27.330909;
constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr std::array<double, 3> kPhiDeg = {105.0, -15.0, -135.0};

constexpr double kDegPerCount = 360.0 / (4 * 320) * 14.25 / 110.0;
constexpr double kZeroDeg = 35.0;

constexpr int kMaxSteps = 15;
constexpr double kCloseMm = 1e-3;
constexpr double kLongestStepMm = 20.0;
constexpr double kSingular = 1e-9;

/// Axes of the vertical plane of one leg: u outward, v sideways, w along z.
struct Leg {
  Vec3 u;
  Vec3 v;
};

Leg leg(std::size_t i) noexcept {
  const double phi = kPhiDeg[i] / kDegPerRad;
  return {.u = {std::cos(phi), std::sin(phi), 0}, .v = {-std::sin(phi), std::cos(phi), 0}};
}

/// The constraint between a leg's angle and the position: 0 = (P - a cos)^2 + (w - a sin)^2 -
/// rho^2, where rho is the parallelogram's length in the leg's plane.
struct Constraint {
  double value = 0;
  /// Derivatives by the position and by the leg's angle.
  Vec3 gradient;
  double by_angle = 0;
};

std::optional<Constraint> constraint(std::size_t i, double angle, Vec3 p) noexcept {
  const Leg plane = leg(i);
  const double pu = dot(plane.u, p) - kR + kC;
  const double pv = dot(plane.v, p) - kS + kF;
  const double square = kB * kB - pv * pv;
  if (!(square > 0)) return std::nullopt;
  const double root = std::sqrt(square);
  const double rho = kD + kE + root;
  const double out = pu - kA * std::cos(angle);
  const double up = p.z - kA * std::sin(angle);
  return Constraint{
      .value = out * out + up * up - rho * rho,
      .gradient = plane.u * (2 * out) + Vec3{0, 0, 2 * up} + plane.v * (2 * rho * pv / root),
      .by_angle = 2 * kA * (out * std::sin(angle) - up * std::cos(angle))};
}

using Rows = std::array<Vec3, 3>;

/// Solves rows * x = right by Cramer's rule. Returns nullopt if the matrix is singular.
std::optional<Vec3> solve(const Rows& rows, Vec3 right) noexcept {
  const Vec3 bc = cross(rows[1], rows[2]);
  const double det = dot(rows[0], bc);
  const double size = length(rows[0]) * length(rows[1]) * length(rows[2]);
  if (!(std::abs(det) > kSingular * size)) return std::nullopt;
  const Vec3 sum =
      bc * right.x + cross(rows[2], rows[0]) * right.y + cross(rows[0], rows[1]) * right.z;
  return sum * (1.0 / det);
}

}  // namespace

double angle_of(std::int16_t count) noexcept {
  return (kZeroDeg + kDegPerCount * count) / kDegPerRad;
}

std::int16_t count_of(double angle_rad) noexcept {
  const double count = std::round((angle_rad * kDegPerRad - kZeroDeg) / kDegPerCount);
  using Limits = std::numeric_limits<std::int16_t>;
  return static_cast<std::int16_t>(
      std::clamp(count, static_cast<double>(Limits::min()), static_cast<double>(Limits::max())));
}

LegTracker::LegTracker() noexcept
    : legs_{StepTracker(kDegPerCount / kDegPerRad), StepTracker(kDegPerCount / kDegPerRad),
            StepTracker(kDegPerCount / kDegPerRad)} {}

LegAngles LegTracker::take(const std::array<std::int16_t, 3>& counts, double dt_s) noexcept {
  LegAngles angles{};
  for (std::size_t i = 0; i < angles.size(); ++i)
    angles[i] = legs_[i].take(angle_of(counts[i]), dt_s);
  return angles;
}

void LegTracker::reset() noexcept {
  for (StepTracker& leg : legs_) leg.reset();
}

std::optional<LegAngles> leg_angles(Vec3 p) noexcept {
  LegAngles angles{};
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const Leg plane = leg(i);
    const double pu = dot(plane.u, p) - kR + kC;
    const double pv = dot(plane.v, p) - kS + kF;
    const double square = kB * kB - pv * pv;
    if (!(square > 0)) return std::nullopt;
    const double rho = kD + kE + std::sqrt(square);
    // a cos(theta) P + a sin(theta) w = (P^2 + w^2 + a^2 - rho^2)/2 is a line that intersects the
    // circle of the knee twice. The Falcon's knees point outward.
    const double reach = std::hypot(pu, p.z);
    const double cosine = (reach * reach + kA * kA - rho * rho) / (2 * kA * reach);
    if (!(std::abs(cosine) <= 1)) return std::nullopt;
    angles[i] = std::atan2(p.z, pu) - std::acos(cosine);
  }
  return angles;
}

std::optional<Vec3> position_of(const LegAngles& angles, Vec3 guess_mm) noexcept {
  Vec3 p = guess_mm;
  for (int step = 0; step < kMaxSteps; ++step) {
    Rows rows;
    std::array<double, 3> values{};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto equation = constraint(i, angles[i], p);
      if (!equation) return std::nullopt;
      rows[i] = equation->gradient;
      values[i] = equation->value;
    }
    const auto move = solve(rows, {-values[0], -values[1], -values[2]});
    if (!move || !is_finite(*move)) return std::nullopt;
    const double step_mm = length(*move);
    p = p + *move * (step_mm > kLongestStepMm ? kLongestStepMm / step_mm : 1.0);
    if (step_mm < kCloseMm) return p;
  }
  return std::nullopt;
}

std::optional<std::array<double, 3>> leg_torques(const LegAngles& angles, Vec3 p,
                                                 Vec3 force_n) noexcept {
  // gradient_i . dp + by_angle_i dtheta_i = 0. With G the matrix of gradients, J = -G^-1 diag(by),
  // so tau_i = -by_i x_i where G^T x = f.
  Rows gradients;
  std::array<double, 3> by_angle{};
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    const auto equation = constraint(i, angles[i], p);
    if (!equation) return std::nullopt;
    gradients[i] = equation->gradient;
    by_angle[i] = equation->by_angle;
  }
  const Rows columns = {Vec3{gradients[0].x, gradients[1].x, gradients[2].x},
                        Vec3{gradients[0].y, gradients[1].y, gradients[2].y},
                        Vec3{gradients[0].z, gradients[1].z, gradients[2].z}};
  const auto x = solve(columns, force_n);
  if (!x || !is_finite(*x)) return std::nullopt;
  return std::array<double, 3>{-by_angle[0] * x->x, -by_angle[1] * x->y, -by_angle[2] * x->z};
}

}  // namespace kerf::agent::falcon
