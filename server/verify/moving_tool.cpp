// SPDX-License-Identifier: Apache-2.0
#include "server/verify/moving_tool.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/math/rotation.h"

namespace kerf {
namespace {

// Accuracy of the least distance along a motion, mm.
constexpr double kBestMm = 1e-6;
// Parts of a motion in which no point of the tool moves farther than this, mm, are approximated by
// a parabola. For a tool of 0.1 mm radius the error is below 1e-7 mm.
constexpr double kPartMm = 0.005;

// Distance of a point from a moving tool as a function of the fraction of the motion.
struct MovingDistance {
  const MovingTool& tool;
  Vec3 point;

  double operator()(double share) const {
    const ToolPose pose = tool.at(share);
    const Vec3 p = point - pose.tip_mm;
    const double h = dot(p, pose.axis);
    return tool.profile->nearest(length(p - pose.axis * h), h).distance_mm;
  }
};

// The distance from a convex body along a straight motion is convex: golden-section search.
NearestPose least_of_convex(const MovingDistance& distance, NearestPose best, double enough_mm) {
  constexpr double kGolden = 0.6180339887498949;
  const double travel_mm = distance.tool.travel_mm;
  double a = 0, b = 1;
  double m1 = b - kGolden, m2 = a + kGolden;
  double f1 = distance(m1), f2 = distance(m2);
  // The minimum in the rest of the interval is lower by at most its length.
  while ((b - a) * travel_mm > kPartMm / 10 && std::min(f1, f2) >= enough_mm) {
    if (std::min(f1, f2) - (b - a) * travel_mm > best.mm) return best;
    if (f1 < f2) {
      b = std::exchange(m2, m1);
      f2 = f1;
      f1 = distance(m1 = b - kGolden * (b - a));
    } else {
      a = std::exchange(m1, m2);
      f1 = f2;
      f2 = distance(m2 = a + kGolden * (b - a));
    }
  }
  if (f1 < best.mm) best = {m1, f1};
  if (f2 < best.mm) best = {m2, f2};
  return best;
}

// The distance changes no faster than the fastest point of the tool moves, so intervals that cannot
// contain a lower value are skipped.
class Search {
 public:
  Search(const MovingDistance& distance, double speed_mm, NearestPose best, double enough_mm)
      : distance_(distance), speed_mm_(speed_mm), best_(best), enough_mm_(enough_mm) {}

  NearestPose run(double first_mm, double last_mm) {
    descend(0, first_mm, 1, last_mm);
    return best_;
  }

 private:
  void descend(double a, double fa, double b, double fb) {
    if (best_.mm < enough_mm_) return;
    if ((fa + fb - speed_mm_ * (b - a)) / 2 >= best_.mm - kBestMm) return;
    const double middle = (a + b) / 2;
    const double fm = distance_(middle);
    offer({middle, fm});
    if (speed_mm_ * (b - a) < kPartMm) {
      const double bend = fa + fb - 2 * fm;
      if (bend > 0) {
        const double t = std::clamp(middle + (b - a) * (fa - fb) / (4 * bend), a, b);
        offer({t, distance_(t)});
      }
      return;
    }
    // The more promising half is searched first, because it may make the other unnecessary.
    const bool left = fa < fb;
    if (left) descend(a, fa, middle, fm);
    descend(middle, fm, b, fb);
    if (!left) descend(a, fa, middle, fm);
  }
  void offer(NearestPose found) {
    if (found.mm < best_.mm) best_ = found;
  }

  const MovingDistance& distance_;
  double speed_mm_;
  NearestPose best_;
  double enough_mm_;
};

}  // namespace

ToolPose MovingTool::at(double share) const {
  const Vec3 axis = turn_rad > 0 ? great_circle(from.axis, to.axis, turn_rad, share) : from.axis;
  return {from.tip_mm + (to.tip_mm - from.tip_mm) * share, axis};
}

Box MovingTool::bounds(double length_mm, double radius_mm) const {
  Box box{from.tip_mm, from.tip_mm};
  for (const ToolPose& pose : {from, to})
    for (const Vec3 end : {pose.tip_mm, pose.tip_mm + pose.axis * length_mm})
      box = around(box, {end, end});
  // The radius, plus the deviation of the upper end from its chord while the axis turns.
  const double more = radius_mm + length_mm * (1 - std::cos(turn_rad / 2));
  return {box.low - Vec3{more, more, more}, box.high + Vec3{more, more, more}};
}

NearestPose nearest_pose(const MovingTool& tool, Vec3 point, NearestPose best, double enough_mm) {
  const MovingDistance distance{tool, point};
  const double lever = std::max(length(point - tool.from.tip_mm), length(point - tool.to.tip_mm));
  const double speed_mm = tool.travel_mm + tool.turn_rad * lever;
  const double first = distance(0), last = distance(1);
  if (first < best.mm) best = {0, first};
  if (last < best.mm) best = {1, last};
  if (best.mm < enough_mm || (first + last - speed_mm) / 2 >= best.mm) return best;
  if (tool.turn_rad == 0 && tool.profile->convex())
    return least_of_convex(distance, best, enough_mm);
  return Search(distance, speed_mm, best, enough_mm).run(first, last);
}

Vec3 outward_of(const ToolProfile& profile, const ToolPose& pose, Vec3 point) {
  const Vec3 p = point - pose.tip_mm;
  const double h = dot(p, pose.axis);
  const Vec3 across = p - pose.axis * h;
  const double r = length(across);
  const auto border = profile.nearest(r, h);
  const Vec3 radial = r > 0 ? across * (1 / r) : any_perpendicular(pose.axis);
  return radial * border.normal_radial + pose.axis * border.normal_along;
}

}  // namespace kerf
