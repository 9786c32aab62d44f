// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/edge_slice.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Cosine of the angle between two ends' normals up to which the surface between them is considered
/// smooth, not creased.
constexpr double kSmoothCosine = 0.985;
/// Pitches. Two tangent planes that miss each other's ends by at most this form one surface.
constexpr double kMissMax = 0.03;
/// Share of the rise between two ends by which the tangent plane of one may miss the other.
constexpr double kBendShare = 0.25;
/// Share of the change of slope between two ends by which a circle through both may miss the slope
/// at the second.
constexpr double kCircleMiss = 0.15;
/// Pitches. Circles of greater radius are treated as lines, because rounding dominates their shape.
constexpr double kRadiusMax = 2000;
/// Least third difference of the heights (pitches) for an ellipse: above the error of the ends,
/// plus the rounding of the normal codes per squared secant of the slope.
constexpr double kThirdMin = 0.02;
/// Shares of the third difference and of the rise between two ends by which an ellipse may miss the
/// end that it was not fitted to. At a crease between the ends it misses by more.
constexpr double kMissOfThird = 0.1, kMissOfRise = 0.3;

}  // namespace

std::optional<Passage> passage(const SliceEnd& a, const SliceEnd& b, double level) {
  const double rise = b.z - a.z, turn = a.slope - b.slope;
  const double chord = rise == 0 ? 0.5 : std::clamp((level - a.z) / rise, 0.0, 1.0);
  // Height of each tangent plane above the other's end.
  const double above_b = a.z + a.slope - b.z, above_a = b.z - b.slope - a.z;
  const bool smooth = dot(a.normal, b.normal) > kSmoothCosine;
  if (std::abs(above_b) <= kMissMax && std::abs(above_a) <= kMissMax) {
    return Passage{chord, normalized(a.normal * (1 - chord) + b.normal * chord), Trust::kBoth};
  }
  const double crease = turn == 0 ? -1 : above_a / turn;  // the tangent planes meet here
  const bool meet = crease >= 0 && crease <= 1;
  const bool turns_out =
      above_a * (a.z - b.z) > 0;  // a ridge: each tangent plane passes outside the other end
  // If the surface is curved, its tangent plane at one end misses the other by part of the rise.
  const double miss_max = kBendShare * std::abs(rise);
  if (!meet && std::abs(above_a) > miss_max && std::abs(above_b) > miss_max) return std::nullopt;
  const double crease_z = a.z + a.slope * crease;
  const bool on_b = meet ? level >= std::min(b.z, crease_z) && level <= std::max(b.z, crease_z)
                         : std::abs(above_a) < std::abs(above_b);
  double place = on_b ? (b.slope != 0 ? 1 + (level - b.z) / b.slope : 1)
                      : (a.slope != 0 ? (level - a.z) / a.slope : 0);
  place = std::clamp(place, 0.0, 1.0);
  const Trust trust = !meet ? Trust::kOne : turns_out ? Trust::kBoth : Trust::kHollow;
  if (!smooth) return Passage{place, on_b ? b.normal : a.normal, trust};
  // A curved surface is midway between its chord and its tangent planes.
  place = 0.5 * (place + chord);
  return Passage{place, normalized(a.normal * (1 - place) + b.normal * place),
                 meet ? Trust::kBoth : Trust::kOne};
}

std::optional<SideArc> SideArc::through(const SliceEnd& b, const SliceEnd& c,
                                        const std::optional<SliceEnd>& d, double up, Vec3 towards) {
  const Slice slice{-b.slope * up, -c.slope * up, (c.z - b.z) * up};
  std::optional<double> farther;
  if (d) farther = (d->z - b.z) * up;
  std::optional<SideArc> arc = ellipse(slice, farther);
  if (!arc) arc = circle(slice);
  if (!arc) return arc;
  const double along = dot(b.normal, towards);
  arc->up_ = up;
  arc->towards_ = towards;
  arc->across_ = b.normal - towards * along - Vec3{0, 0, b.normal.z};
  arc->within_ = std::sqrt(along * along + b.normal.z * b.normal.z);
  return arc;
}

/// With (X, Z) relative to its center, an ellipse s²X² + Z² = R² has the slope -s²X/Z. Two ends one
/// pitch apart determine the four unknowns in closed form, and the third end verifies the fit.
std::optional<SideArc> SideArc::ellipse(const Slice& slice, const std::optional<double>& d) {
  const double m = slice.b_slope, rise = -slice.behind;
  const double third = slice.c_slope + m - 2 * rise;
  if (!d || m <= 0 || third < kThirdMin + kThirdOfSecant * (1 + m * m)) return std::nullopt;
  const double zc = rise * (rise - m) / third, zb = zc + rise;
  if (zb >= 0 || zc >= 0) return std::nullopt;
  const double squares = zc * slice.c_slope - zb * m;  // s²
  if (squares <= 0) return std::nullopt;
  SideArc arc;
  const double xb = -zb * m / squares;
  const double radius_2 = zb * zb + squares * xb * xb;
  const double under = radius_2 - squares * (xb - 2) * (xb - 2);
  const double miss_max = std::min(kMissOfThird * third, kMissOfRise * rise);
  if (under < 0 || std::abs(-std::sqrt(under) - zb - *d) > miss_max) return std::nullopt;
  arc.center_u_ = -xb;
  arc.center_w_ = -zb;
  arc.radius_ = std::sqrt(radius_2);
  arc.squeeze_ = std::sqrt(squares);
  return arc;
}

/// Tangent to the surface at `b`, through `c`. The slope at `c` verifies the fit.
std::optional<SideArc> SideArc::circle(const Slice& slice) {
  const double m = slice.b_slope, size = std::sqrt(1 + m * m);
  const double bend = (m + slice.behind) / size;  // distance of `c` from the tangent
  const double chord = 1 + slice.behind * slice.behind;
  if (bend * 2 * kRadiusMax <= chord) return std::nullopt;
  SideArc arc;
  arc.radius_ = chord / (2 * bend);
  arc.center_u_ = -arc.radius_ * m / size;
  arc.center_w_ = arc.radius_ / size;
  const double over_c = arc.center_w_ - slice.behind;
  if (over_c <= 0) return std::nullopt;
  const double miss = -(arc.center_u_ + 1) / over_c - slice.c_slope;
  if (std::abs(miss) > kCircleMiss * (m - slice.c_slope)) return std::nullopt;
  return arc;
}

double SideArc::below_center(double w) const { return std::max(center_w_ - w, 0.0); }

double SideArc::u(double w) const {
  const double below = below_center(w);
  return center_u_ + std::sqrt(std::max(radius_ * radius_ - below * below, 0.0)) / squeeze_;
}

Vec3 SideArc::normal(double w) const {
  const double below = below_center(w);
  const double out = std::sqrt(std::max(radius_ * radius_ - below * below, 0.0)) * squeeze_;
  const double size = std::sqrt(out * out + below * below);
  if (size == 0) return across_ + Vec3{0, 0, up_ * within_};
  // The component of the normal of `b` across the slice is constant along the arc.
  return normalized(across_ + (Vec3{0, 0, up_ * below} - towards_ * out) * (within_ / size));
}

}  // namespace kerf
