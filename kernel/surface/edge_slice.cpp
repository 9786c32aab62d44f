// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/edge_slice.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Cosine of the angle between two ends' normals up to which the surface between them is bent, not
/// creased.
constexpr double kSmoothCosine = 0.985;
/// Pitches. By so much two planes may miss each other and still be one surface.
constexpr double kMissMax = 0.03;
/// By this share of the rise between two ends the plane of one may miss the other.
constexpr double kBendShare = 0.25;
/// By this share of the bend between two ends a circle through both may miss the slope of the
/// second.
constexpr double kCircleMiss = 0.15;
/// Pitches. A circle that bends less is a line: rounding decides where it ends.
constexpr double kRadiusMax = 2000;
/// The third difference of the heights (pitches) from which on an ellipse is more than what the
/// ends may err, and for each square of a secant more than the rounding of the normals' codes.
constexpr double kThirdMin = 0.02;
/// By these shares of the third difference and of the rise between two ends an ellipse may miss the
/// end that it was not fitted to: at a crease between the ends it misses by more.
constexpr double kMissOfThird = 0.1, kMissOfRise = 0.3;

}  // namespace

std::optional<Passage> passage(const SliceEnd& a, const SliceEnd& b, double level) {
  const double rise = b.z - a.z, turn = a.slope - b.slope;
  const double chord = rise == 0 ? 0.5 : std::clamp((level - a.z) / rise, 0.0, 1.0);
  // By so much each plane lies above the other's end.
  const double above_b = a.z + a.slope - b.z, above_a = b.z - b.slope - a.z;
  const bool smooth = dot(a.normal, b.normal) > kSmoothCosine;
  if (std::abs(above_b) <= kMissMax && std::abs(above_a) <= kMissMax) {
    return Passage{chord, normalized(a.normal * (1 - chord) + b.normal * chord), Trust::kBoth};
  }
  const double crease = turn == 0 ? -1 : above_a / turn;  // the planes meet here
  const bool meet = crease >= 0 && crease <= 1;
  const bool turns_out =
      above_a * (a.z - b.z) > 0;  // a ridge: each plane passes beyond the other end
  // One surface is bent, and its plane misses the other end, where it meets that one's surface.
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
  // Of a bent surface the chord is as far on one side as the planes are on the other.
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

/// With heights Z and ways X from its centre, an ellipse s²X² + Z² = R² has the slope -s²X/Z. Two
/// ends one pitch apart give the four unknowns in closed form, the third end says whether it is
/// one.
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

/// Along the tangent of `b`, through `c`; its tangent there tells whether it is one.
std::optional<SideArc> SideArc::circle(const Slice& slice) {
  const double m = slice.b_slope, size = std::sqrt(1 + m * m);
  const double bend = (m + slice.behind) / size;  // of `c`, from the tangent
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

double SideArc::way(double w) const {
  const double below = below_center(w);
  return center_u_ + std::sqrt(std::max(radius_ * radius_ - below * below, 0.0)) / squeeze_;
}

Vec3 SideArc::normal(double w) const {
  const double below = below_center(w);
  const double out = std::sqrt(std::max(radius_ * radius_ - below * below, 0.0)) * squeeze_;
  const double size = std::sqrt(out * out + below * below);
  if (size == 0) return across_ + Vec3{0, 0, up_ * within_};
  // What the normal of `b` has across the slice it keeps along the arc.
  return normalized(across_ + (Vec3{0, 0, up_ * below} - towards_ * out) * (within_ / size));
}

}  // namespace kerf
