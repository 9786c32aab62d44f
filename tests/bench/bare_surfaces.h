// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kernel/math/targets.h"
#include "kernel/math/vec3.h"
#include "kernel/tool/tool_pose.h"
#include "tests/bench/bare_loop.h"

// Lower ends of rays in swept tools of 10 mm diameter, for the bare loops: at(x, y) returns the
// height at which a ray enters, or kMissed. No branches, so that the loops are vectorised.

namespace kerf::test {

inline constexpr float kMissed = 1e9F, kBareRadius = 5, kCornerRadius = 2, kFlatRadius = 3;

struct Vec3f {
  float x, y, z;
  explicit Vec3f(Vec3 v) : x(float(v.x)), y(float(v.y)), z(float(v.z)) {}
};

KERF_INLINE float root_of(float v) { return std::sqrt(v > 0 ? v : 0.0F); }
KERF_INLINE float lower_of(float a, float b) { return a < b ? a : b; }

/// An upright tool in horizontal translation: its profile over the distance from the path.
template <BareTool kTool>
struct UprightSweep {
  float x, y, z, dx, dy, per_length2;

  UprightSweep(const ToolPose& from, const ToolPose& to)
      : x(float(from.tip_mm.x)),
        y(float(from.tip_mm.y)),
        z(float(from.tip_mm.z)),
        dx(float(to.tip_mm.x - from.tip_mm.x)),
        dy(float(to.tip_mm.y - from.tip_mm.y)),
        per_length2(1 / (dx * dx + dy * dy)) {}

  KERF_INLINE float at(float ray_x, float ray_y) const {
    const float px = ray_x - x, py = ray_y - y;
    float s = (px * dx + py * dy) * per_length2;
    s = s > 0 ? s : 0;
    s = s < 1 ? s : 1;
    const float ex = px - s * dx, ey = py - s * dy, r2 = ex * ex + ey * ey;
    const float inside = kBareRadius * kBareRadius - r2;
    float low = z;
    if (kTool == BareTool::kBall) low = z + kBareRadius - root_of(inside);
    if (kTool == BareTool::kBullNose) {
      const float m = root_of(r2) - kFlatRadius, over = m > 0 ? m : 0;
      low = z + kCornerRadius - root_of(kCornerRadius * kCornerRadius - over * over);
    }
    return inside > 0 ? low : kMissed;
  }
};

/// A cylinder from `base` along `axis` without an upper end; with a round lower end it is a
/// capsule.
struct Cylinder {
  Vec3f base, axis;
  float lean2, per_lean2, length;

  Cylinder(Vec3 b, Vec3 u, double length_mm) : base(b), axis(u), length(float(length_mm)) {
    const double a = 1 - u.z * u.z;
    lean2 = float(a > 1e-6 ? a : 1e-6);
    per_lean2 = 1 / lean2;
  }
  /// Returns where the ray enters the side, or the disc at the base if `with_disc`.
  template <bool with_disc>
  KERF_INLINE float at(float ray_x, float ray_y) const {
    const float px = ray_x - base.x, py = ray_y - base.y;
    const float along = px * axis.x + py * axis.y, b = -along * axis.z;
    const float inside =
        b * b - lean2 * (px * px + py * py - along * along - kBareRadius * kBareRadius);
    const float root = root_of(inside), in = (-b - root) * per_lean2;
    if (!with_disc) {
      const float l = along + in * axis.z;
      const bool hit = (inside >= 0) & (l >= 0) & (l <= length);
      return hit ? base.z + in : kMissed;
    }
    const float out = (root - b) * per_lean2, disc = -along / axis.z;
    const float low = in > disc ? in : disc;
    const bool hit = (inside >= 0) & (low <= out);
    return hit ? base.z + low : kMissed;
  }
};

/// The lower one of the two parallelograms that the side of a cylinder sweeps.
struct SweptSide {
  Vec3f corner, d, u;
  float per_det;

  SweptSide(Vec3 base, Vec3 move, Vec3 side) : corner(base), d(move), u(side), per_det(0) {
    const Vec3 n = cross(move, side);
    const double size = length(n), det = move.x * side.y - move.y * side.x;
    if (size < 1e-9 || std::abs(det) < 1e-9) return;
    corner = Vec3f(base + n * ((n.z > 0 ? -1 : 1) * double(kBareRadius) / size));
    per_det = float(1 / det);
  }
  KERF_INLINE float at(float ray_x, float ray_y) const {
    const float px = ray_x - corner.x, py = ray_y - corner.y;
    const float s = (px * u.y - py * u.x) * per_det, t = (d.x * py - d.y * px) * per_det;
    const bool within = (per_det != 0) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1);
    return within ? corner.z + s * d.z + t * u.z : kMissed;
  }
};

KERF_INLINE float enter_ball(Vec3f c, float ray_x, float ray_y) {
  const float x = ray_x - c.x, y = ray_y - c.y, inside = kBareRadius * kBareRadius - x * x - y * y;
  return inside >= 0 ? c.z - root_of(inside) : kMissed;
}

/// The corner of a bull-nose at one pose, by three steps to the root of a parabola from the height
/// of an upright one, and the cylinder above it.
struct Nose {
  Cylinder shaft;

  explicit Nose(const ToolPose& p)
      : shaft(p.tip_mm + p.axis * double(kCornerRadius), p.axis, 1e6) {}

  KERF_INLINE float at(float ray_x, float ray_y) const {
    const Vec3f& u = shaft.axis;
    const float px = ray_x - shaft.base.x, py = ray_y - shaft.base.y, p2 = px * px + py * py;
    const float along = px * u.x + py * u.y, lean2 = 1 - u.z * u.z;
    float t = -along / u.z;
    const float rim = root_of(p2 + t * t) - kFlatRadius, over = rim > 0 ? rim : 0;
    t -= root_of(kCornerRadius * kCornerRadius - over * over) / u.z;
    float inside = 0;
    for (int i = 0; i < 3; ++i) {
      const float l = along + u.z * t, rho = root_of(p2 + t * t - l * l) + 1e-6F;
      const float excess = rho - kFlatRadius, m = excess > 0 ? excess : 0;
      const float growth = (t - l * u.z) / rho;
      const float bend =
          (m > 0 ? lean2 - (lean2 - growth * growth) * kFlatRadius / rho : 0.0F) + u.z * u.z;
      const float slope = m * growth + l * u.z;
      inside = slope * slope - bend * (m * m + l * l - kCornerRadius * kCornerRadius);
      t -= (slope + root_of(inside)) / bend;
    }
    const bool hit = (inside >= 0) & (along + u.z * t <= 0);
    const float corner = hit ? shaft.base.z + t : kMissed;
    return lower_of(corner, shaft.at<true>(ray_x, ray_y));
  }
};

/// A tool that turns, in one sub-motion.
template <BareTool kTool>
struct TurningMove;

template <>
struct TurningMove<BareTool::kBall> {
  static constexpr double kLength = 45;
  Vec3 c0, c1, middle;
  Vec3f first_center, last_center;
  Cylinder first, last, path;
  SweptSide side;

  TurningMove(const ToolPose& from, const ToolPose& to)
      : c0(from.tip_mm + from.axis * double(kBareRadius)),
        c1(to.tip_mm + to.axis * double(kBareRadius)),
        middle(normalized(from.axis + to.axis)),
        first_center(c0),
        last_center(c1),
        first(c0, from.axis, kLength),
        last(c1, to.axis, kLength),
        path(c0, normalized(c1 - c0), length(c1 - c0)),
        side(c0, c1 - c0, middle * kLength) {}
  KERF_INLINE float at(float x, float y) const {
    const float bodies = lower_of(lower_of(first.at<false>(x, y), last.at<false>(x, y)),
                                  lower_of(path.at<false>(x, y), side.at(x, y)));
    return lower_of(bodies,
                    lower_of(enter_ball(first_center, x, y), enter_ball(last_center, x, y)));
  }
};

template <>
struct TurningMove<BareTool::kFlat> {
  Cylinder first, last;

  TurningMove(const ToolPose& from, const ToolPose& to)
      : first(from.tip_mm, from.axis, 50), last(to.tip_mm, to.axis, 50) {}
  KERF_INLINE float at(float x, float y) const {
    return lower_of(first.at<true>(x, y), last.at<true>(x, y));
  }
};

template <>
struct TurningMove<BareTool::kBullNose> {
  Nose first, last;

  TurningMove(const ToolPose& from, const ToolPose& to) : first(from), last(to) {}
  KERF_INLINE float at(float x, float y) const { return lower_of(first.at(x, y), last.at(x, y)); }
};

}  // namespace kerf::test
