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
constexpr int kCellsPerSide = 256;
constexpr int kStepsMax = 64;

Vec3 least(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3 greatest(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

BoxStock bounds_of(const StockShape& stock) {
  if (const auto* box = std::get_if<BoxStock>(&stock)) return *box;
  const auto& c = std::get<CylinderStock>(stock);
  return {{c.center_x_mm - c.radius_mm, c.center_y_mm - c.radius_mm, c.min_z_mm},
          {c.center_x_mm + c.radius_mm, c.center_y_mm + c.radius_mm, c.max_z_mm}};
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
  for (const ProgramMotion& motion : motions) {
    const Tool& tool = tools.at(motion.tool).tool;
    const ToolMotion m =
        make_motion({motion.from.tip_mm, normalized(motion.from.axis)},
                    {motion.to.tip_mm, normalized(motion.to.axis)}, tool.length_mm);
    Sweep sweep{&profiles_.at(motion.tool), m.from, m.to, m.turn_rad, m.travel_mm, {}, {}};
    sweep.low = sweep.high = m.from.tip_mm;
    for (const ToolPose& pose : {m.from, m.to}) {
      for (const Vec3 end : {pose.tip_mm, pose.tip_mm + pose.axis * tool.length_mm}) {
        sweep.low = least(sweep.low, end);
        sweep.high = greatest(sweep.high, end);
      }
    }
    // The radius, plus the deviation of the upper end from its chord while the axis turns.
    const double more = tool.radius_mm + tool.length_mm * (1 - std::cos(m.turn_rad / 2));
    sweep.low = sweep.low - Vec3{more, more, more};
    sweep.high = sweep.high + Vec3{more, more, more};
    sweeps_.push_back(sweep);
  }
  fill_cells(reach_mm);
}

void TrueSolid::fill_cells(double reach_mm) {
  const BoxStock box = bounds_of(stock_);
  origin_ = box.min_mm;
  const Vec3 size = box.max_mm - box.min_mm;
  cell_mm_ = std::max(size.x, size.y) / kCellsPerSide;
  cells_x_ = static_cast<std::int32_t>(size.x / cell_mm_) + 1;
  cells_y_ = static_cast<std::int32_t>(size.y / cell_mm_) + 1;
  std::vector<std::vector<std::uint32_t>> lists(std::size_t(cells_x_) * std::size_t(cells_y_));
  const auto column = [&](double offset, std::int32_t count) {
    return std::int32_t(std::clamp(std::floor(offset / cell_mm_), 0.0, double(count - 1)));
  };
  for (std::uint32_t n = 0; n < sweeps_.size(); ++n) {
    const Vec3 low = sweeps_[n].low - origin_, high = sweeps_[n].high - origin_;
    if (low.z - reach_mm > size.z) continue;
    const std::int32_t x1 = column(high.x + reach_mm, cells_x_);
    const std::int32_t y1 = column(high.y + reach_mm, cells_y_);
    for (std::int32_t y = column(low.y - reach_mm, cells_y_); y <= y1; ++y)
      for (std::int32_t x = column(low.x - reach_mm, cells_x_); x <= x1; ++x)
        lists[std::size_t(y * cells_x_ + x)].push_back(n);
  }
  for (const auto& list : lists) {
    const auto begin = static_cast<std::uint32_t>(near_.size());
    near_.insert(near_.end(), list.begin(), list.end());
    cells_.push_back({begin, static_cast<std::uint32_t>(near_.size())});
  }
}

TrueSolid::Cell TrueSolid::cell_of(Vec3 point) const {
  const auto column = [this](double offset, std::int32_t count) {
    return std::int32_t(std::clamp(std::floor(offset / cell_mm_), 0.0, double(count - 1)));
  };
  const std::int32_t x = column(point.x - origin_.x, cells_x_);
  const std::int32_t y = column(point.y - origin_.y, cells_y_);
  return cells_[std::size_t(y * cells_x_ + x)];
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
TrueSolid::Signed TrueSolid::from_sweeps(Vec3 point) const {
  Least best{0, reach_mm_};
  const Sweep* nearest = nullptr;
  const Cell cell = cell_of(point);
  for (std::uint32_t n = cell.begin; n < cell.end; ++n) {
    const Sweep& s = sweeps_[near_[n]];
    const Vec3 below = s.low - point, above = point - s.high;
    if (std::max({below.x, below.y, below.z, above.x, above.y, above.z}) >= best.mm) continue;
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
    if (found.mm >= best.mm) continue;
    best = found;
    nearest = &s;
  }
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

TrueSolid::Distance TrueSolid::distance(Vec3 point) const {
  const Signed stock = from_stock(point);
  const Signed sweeps = from_sweeps(point);
  if (stock.mm <= 0 && sweeps.mm >= 0)
    return {std::min(-stock.mm, sweeps.mm), sweeps.mm < -stock.mm};
  // Outside the solid: moves the point out of the sweep that contains it deepest, until none does.
  const bool cut = -sweeps.mm > stock.mm;
  Vec3 at = point;
  Signed from = stock, cuts = sweeps;
  double left = std::max(from.mm, -cuts.mm);
  const double at_least = left;
  for (int step = 0; step < kStepsMax && left > kFoundMm; ++step) {
    at = -cuts.mm > from.mm ? at - cuts.outward * cuts.mm : at - from.outward * from.mm;
    from = from_stock(at);
    cuts = from_sweeps(at);
    left = std::max(from.mm, -cuts.mm);
  }
  return {std::max(at_least, length(at - point) + std::max(0.0, left)), cut};
}

}  // namespace kerf
