// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/contact_patch.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "kernel/math/rotation.h"

namespace kerf {
namespace {

/// A shorter half axis counts as zero: the contact is a point or a line.
constexpr double kLeastHalfMm = 0.1;
/// Half axes in standard deviations. Springs at the rim of that ellipse then resist turning as an
/// area does whose pressure grows with the square of the depth, as the weights do.
constexpr double kDeviations = 2;

/// Points of a plane, as multiples of its half axes. Their mean is zero, and the mean of their
/// squares along each half axis is one half.
struct Corner {
  double a, b;
};
constexpr double kHalfRoot2 = 0.70710678118654752440;
constexpr double kHalfRoot3 = 0.86602540378443864676;
constexpr Corner kTriangle[] = {{1, 0}, {-0.5, kHalfRoot3}, {-0.5, -kHalfRoot3}};
constexpr Corner kPair[] = {{kHalfRoot2, 0}, {-kHalfRoot2, 0}};

std::span<const Corner> corners_of(const ContactPlane& plane) {
  const double a = length(plane.half_a_mm), b = length(plane.half_b_mm);
  if (!(a > kLeastHalfMm)) return {};
  return b > kLeastHalfMm ? std::span<const Corner>(kTriangle) : std::span<const Corner>(kPair);
}

}  // namespace

void PatchSum::add(Vec3 point_mm, double weight) {
  if (!(weight > 0)) return;
  if (weight_ == 0) origin_mm_ = point_mm;
  const Vec3 p = point_mm - origin_mm_;
  weight_ += weight;
  moment_ = moment_ + p * weight;
  squares_ = squares_ + Vec3{p.x * p.x, p.y * p.y, p.z * p.z} * weight;
  products_ = products_ + Vec3{p.y * p.z, p.z * p.x, p.x * p.y} * weight;
}

Vec3 PatchSum::center_mm() const { return origin_mm_ + moment_ * (1 / weight_); }

void PatchSum::place(ContactPlane& plane) const {
  if (!(weight_ > 0)) return;
  plane.point_mm = center_mm();
  const Vec3 mean = moment_ * (1 / weight_);
  const auto covariance = [&](Vec3 v) {
    const Vec3 s = squares_ * (1 / weight_), p = products_ * (1 / weight_);
    return Vec3{s.x * v.x + p.z * v.y + p.y * v.z, p.z * v.x + s.y * v.y + p.x * v.z,
                p.y * v.x + p.x * v.y + s.z * v.z} -
           mean * dot(mean, v);
  };
  // The eigenvectors of the covariance within the plane.
  const Vec3 u = any_perpendicular(plane.normal), v = cross(plane.normal, u);
  const Vec3 cu = covariance(u);
  const double uu = dot(u, cu), uv = dot(v, cu), vv = dot(v, covariance(v));
  const double middle = (uu + vv) / 2, half = (uu - vv) / 2;
  const double root = std::sqrt(half * half + uv * uv);
  const Vec3 first =
      root > 0 ? (half > 0 ? u * (half + root) + v * uv : u * uv + v * (root - half)) : u;
  const Vec3 a = normalized(first);
  plane.half_a_mm = a * (kDeviations * std::sqrt(std::max(0.0, middle + root)));
  plane.half_b_mm =
      cross(plane.normal, a) * (kDeviations * std::sqrt(std::max(0.0, middle - root)));
}

bool touches_with_a_point(const ConvexPart& part, double z_mm) {
  const auto* arc = std::get_if<ArcPiece>(&piece_at(part, z_mm));
  return arc != nullptr && arc->center_r_mm == 0;
}

std::vector<ContactPlane> spread(std::span<const ContactPlane> planes, std::size_t most) {
  std::vector<ContactPlane> points;
  const std::size_t count = std::min(planes.size(), most);
  std::size_t spare = most - count;
  for (const ContactPlane& plane : planes.first(count)) {
    const auto corners = plane.depth_mm > 0 ? corners_of(plane) : std::span<const Corner>();
    if (corners.empty() || corners.size() - 1 > spare) {
      points.push_back(plane);
      continue;
    }
    spare -= corners.size() - 1;
    ContactPlane point = plane;
    point.stiffness_n_per_mm = plane.stiffness_n_per_mm / static_cast<double>(corners.size());
    point.half_a_mm = point.half_b_mm = {};
    for (const Corner& corner : corners) {
      point.point_mm = plane.point_mm + plane.half_a_mm * corner.a + plane.half_b_mm * corner.b;
      point.continues = &corner != corners.data();
      points.push_back(point);
    }
  }
  return points;
}

}  // namespace kerf
