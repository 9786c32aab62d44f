// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/obstacle_patch.h"

#include "kernel/force/signed_distance.h"
#include "kernel/math/rotation.h"

namespace kerf {
namespace {

constexpr int kHeights = 8;       ///< sections along the side
constexpr int kRings = 2;         ///< of the discs at the ends, within their rims
constexpr double kEndMm = 0.001;  ///< circles this near to an end belong to the disc there

/// Sixteen directions of a circle, relative to that of the deepest point, without trigonometry.
struct Direction {
  double along, aside;
};
constexpr double kCos1 = 0.92387953251128674, kSin1 = 0.38268343236508977;
constexpr double kCos2 = 0.70710678118654752;
constexpr Direction kDirections[] = {{1, 0},  {kCos1, kSin1},   {kCos2, kCos2},   {kSin1, kCos1},
                                     {0, 1},  {-kSin1, kCos1},  {-kCos2, kCos2},  {-kCos1, kSin1},
                                     {-1, 0}, {-kCos1, -kSin1}, {-kCos2, -kCos2}, {-kSin1, -kCos1},
                                     {0, -1}, {kSin1, -kCos1},  {kCos2, -kCos2},  {kCos1, -kSin1}};

class Sampler {
 public:
  Sampler(const ToolPose& pose, const Obstacle& obstacle, Vec3 deepest_mm)
      : pose_(pose), obstacle_(obstacle) {
    const Vec3 p = deepest_mm - pose.tip_mm;
    const Vec3 across = p - pose.axis * dot(p, pose.axis);
    along_ = dot(across, across) > 0 ? normalized(across) : any_perpendicular(pose.axis);
    aside_ = cross(pose.axis, along_);
  }
  /// Adds a point. `area` is proportional to the area that it represents.
  void add(Vec3 point_mm, double area) {
    const double depth = -signed_distance(obstacle_, point_mm).distance_mm;
    if (depth > 0) sum_.add(point_mm, depth * depth * area);
  }
  void add_circle(double z_mm, double r_mm, double width_mm) {
    const Vec3 center = pose_.tip_mm + pose_.axis * z_mm;
    for (const Direction& d : kDirections)
      add(center + along_ * (r_mm * d.along) + aside_ * (r_mm * d.aside), r_mm * width_mm);
  }
  /// Adds the rim and two rings of a disc.
  void add_disc(double z_mm, double r_mm) {
    if (!(r_mm > 0)) return;
    for (int n = 0; n < kRings; ++n)
      add_circle(z_mm, r_mm * (n + 1) / (kRings + 1), r_mm / (kRings + 1));
    add_circle(z_mm, r_mm, r_mm / (2 * (kRings + 1)));
  }
  const PatchSum& sum() const { return sum_; }

 private:
  ToolPose pose_;
  const Obstacle& obstacle_;
  Vec3 along_, aside_;
  PatchSum sum_;
};

}  // namespace

PatchSum obstacle_patch(const ConvexPart& part, const ToolPose& pose, const Obstacle& obstacle,
                        Vec3 deepest_mm) {
  Sampler sampler(pose, obstacle, deepest_mm);
  const Extent whole = extent(part);
  const double section = (whole.z1_mm - whole.z0_mm) / kHeights;
  const double middle = dot(deepest_mm - pose.tip_mm, pose.axis);
  if (!touches_with_a_point(part, middle)) {
    for (const double z : {whole.z0_mm, whole.z1_mm}) sampler.add_disc(z, radius_at(part, z));
    // Centered on the deepest point, so that a contact shorter than a section has its center there.
    for (int n = -kHeights; n <= kHeights; ++n) {
      const double z = middle + section * n;
      if (z > whole.z0_mm + kEndMm && z < whole.z1_mm - kEndMm)
        sampler.add_circle(z, radius_at(part, z), section);
    }
  }
  // Such a small part of the whole that it matters only if there is little else.
  const double radius = whole.radius_mm;
  sampler.add(deepest_mm, 0.001 * radius * radius);
  return sampler.sum();
}

}  // namespace kerf
