// SPDX-License-Identifier: Apache-2.0
#include "server/carve/true_solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/force/signed_distance.h"
#include "kernel/math/rotation.h"
#include "kernel/sweep/tool_motion.h"

namespace kerf {
namespace {

// mm. Accuracy of the least distance along a motion.
constexpr double kFoundMm = 1e-6;
// mm. Parts of a motion in which no point of the tool moves farther are approximated by a parabola;
// for a tool of 0.1 mm radius the error is below 1e-7 mm.
constexpr double kPartMm = 0.005;
constexpr int kStepsMax = 64;

Vec3 least(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3 greatest(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

// Distance of a point from a moving tool as a function of the fraction of the motion.
struct MovingDistance {
  const ToolProfile& tool;
  ToolPose from, to;
  double turn_rad;
  Vec3 point;

  ToolPose at(double share) const {
    const Vec3 axis = turn_rad > 0 ? great_circle(from.axis, to.axis, turn_rad, share) : from.axis;
    return {from.tip_mm + (to.tip_mm - from.tip_mm) * share, axis};
  }
  double operator()(double share) const {
    const ToolPose pose = at(share);
    const Vec3 p = point - pose.tip_mm;
    const double h = dot(p, pose.axis);
    return tool.nearest(length(p - pose.axis * h), h).distance_mm;
  }
};

struct Least {
  double share, mm;
};

// The distance from a convex body along a straight motion is convex: golden-section search.
Least least_of_convex(const MovingDistance& distance, double travel_mm, Least best) {
  constexpr double kGolden = 0.6180339887498949;
  double a = 0, b = 1;
  double m1 = b - kGolden, m2 = a + kGolden;
  double f1 = distance(m1), f2 = distance(m2);
  // The minimum in the rest of the interval is lower by at most its length.
  while ((b - a) * travel_mm > kPartMm / 10) {
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

// The distance changes no faster than the fastest point of the tool moves: intervals that cannot
// contain a lower value are skipped.
class Search {
 public:
  Search(const MovingDistance& distance, double speed_mm, Least best)
      : distance_(distance), speed_mm_(speed_mm), best_(best) {}

  Least run(double first_mm, double last_mm) {
    descend(0, first_mm, 1, last_mm);
    return best_;
  }

 private:
  void descend(double a, double fa, double b, double fb) {
    if ((fa + fb - speed_mm_ * (b - a)) / 2 >= best_.mm - kFoundMm) return;
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
    // The more promising half is searched first; it may make the other unnecessary.
    const bool left = fa < fb;
    if (left) descend(a, fa, middle, fm);
    descend(middle, fm, b, fb);
    if (!left) descend(a, fa, middle, fm);
  }
  void offer(Least found) {
    if (found.mm < best_.mm) best_ = found;
  }

  const MovingDistance& distance_;
  double speed_mm_;
  Least best_;
};

}  // namespace

TrueSolid::TrueSolid(const StockShape& stock, const std::map<ToolId, SceneTool>& tools,
                     const std::vector<ProgramMotion>& motions, double reach_mm)
    : stock_(stock), reach_mm_(reach_mm) {
  for (const auto& [id, tool] : tools) profiles_.emplace(id, ToolProfile(tool.tool));
  std::vector<Box> boxes;
  for (const ProgramMotion& motion : motions) {
    const Tool& tool = tools.at(motion.tool).tool;
    const ToolMotion m =
        make_motion({motion.from.tip_mm, normalized(motion.from.axis)},
                    {motion.to.tip_mm, normalized(motion.to.axis)}, tool.length_mm);
    Sweep sweep{&profiles_.at(motion.tool), m.from, m.to, m.turn_rad, m.travel_mm};
    Box box{m.from.tip_mm, m.from.tip_mm};
    for (const ToolPose& pose : {m.from, m.to}) {
      for (const Vec3 end : {pose.tip_mm, pose.tip_mm + pose.axis * tool.length_mm}) {
        box.low = least(box.low, end);
        box.high = greatest(box.high, end);
      }
    }
    // The radius, plus the deviation of the upper end from its chord while the axis turns.
    const double more = tool.radius_mm + tool.length_mm * (1 - std::cos(m.turn_rad / 2));
    box.low = box.low - Vec3{more, more, more};
    box.high = box.high + Vec3{more, more, more};
    boxes.push_back(box);
    sweeps_.push_back(sweep);
  }
  tree_ = BoxTree(boxes);
}

TrueSolid::Signed TrueSolid::from_stock(Vec3 point) const {
  const SignedDistance d = std::visit(
      [&](const auto& stock) {
        using Shape = std::decay_t<decltype(stock)>;
        if constexpr (std::is_same_v<Shape, BoxStock>)
          return signed_distance(BoxObstacle{stock.min_mm, stock.max_mm}, point);
        else
          return signed_distance(
              CylinderObstacle{{stock.center_x_mm, stock.center_y_mm, stock.min_z_mm},
                               {stock.center_x_mm, stock.center_y_mm, stock.max_z_mm},
                               stock.radius_mm},
              point);
      },
      stock_);
  return {d.distance_mm, d.outward};
}

// Negative inside a cut, limited to the reach.
TrueSolid::Signed TrueSolid::from_sweeps(Vec3 point, const std::stop_token& stop) const {
  Least best{0, reach_mm_};
  const Sweep* nearest = nullptr;
  tree_.visit_nearest(point, best.mm, [&](std::uint32_t n) {
    if (stop.stop_requested()) return;
    const Sweep& s = sweeps_[n];
    const MovingDistance distance{*s.tool, s.from, s.to, s.turn_rad, point};
    const double lever = std::max(length(point - s.from.tip_mm), length(point - s.to.tip_mm));
    const double speed_mm = s.travel_mm + s.turn_rad * lever;
    const double first = distance(0), last = distance(1);
    Least found = first < last ? Least{0, first} : Least{1, last};
    if (found.mm > best.mm) found.mm = best.mm;
    if ((first + last - speed_mm) / 2 < found.mm) {
      found = s.turn_rad == 0 && s.tool->convex()
                  ? least_of_convex(distance, s.travel_mm, found)
                  : Search(distance, speed_mm, found).run(first, last);
    }
    if (found.mm >= best.mm) return;
    best = found;
    nearest = &s;
  });
  if (nearest == nullptr) return {reach_mm_, {0, 0, 1}};
  const MovingDistance distance{*nearest->tool, nearest->from, nearest->to, nearest->turn_rad,
                                point};
  const ToolPose pose = distance.at(best.share);
  const Vec3 p = point - pose.tip_mm;
  const double h = dot(p, pose.axis);
  const Vec3 across = p - pose.axis * h;
  const double r = length(across);
  const auto border = nearest->tool->nearest(r, h);
  const Vec3 radial = r > 0 ? across * (1 / r) : any_perpendicular(pose.axis);
  return {best.mm, radial * border.normal_radial + pose.axis * border.normal_along};
}

TrueSolid::Distance TrueSolid::distance(Vec3 point, const std::stop_token& stop) const {
  const Signed stock = from_stock(point);
  const Signed sweeps = from_sweeps(point, stop);
  if (stock.mm <= 0 && sweeps.mm >= 0)
    return {std::min(-stock.mm, sweeps.mm), sweeps.mm < -stock.mm};
  // Outside the solid: moves the point out of the sweep that contains it deepest, until none does.
  const bool cut = -sweeps.mm > stock.mm;
  Vec3 at = point;
  Signed from = stock, cuts = sweeps;
  double left = std::max(from.mm, -cuts.mm);
  const double at_least = left;
  for (int step = 0; step < kStepsMax && left > kFoundMm && !stop.stop_requested(); ++step) {
    at = -cuts.mm > from.mm ? at - cuts.outward * cuts.mm : at - from.outward * from.mm;
    from = from_stock(at);
    cuts = from_sweeps(at, stop);
    left = std::max(from.mm, -cuts.mm);
  }
  return {std::max(at_least, length(at - point) + std::max(0.0, left)), cut};
}

}  // namespace kerf
