// SPDX-License-Identifier: Apache-2.0
#include "server/verify/true_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/force/signed_distance.h"

namespace kerf {
namespace {

constexpr double kFoundMm = 1e-6;
constexpr int kStepsMax = 64;
// Consecutive motions are near each other.
constexpr std::uint32_t kMotionsPerRun = 8;

}  // namespace

TrueSolid::TrueSolid(const StockShape& stock, const std::map<ToolId, SceneTool>& tools,
                     const std::vector<ProgramMotion>& motions, double reach_mm,
                     const TriangleMesh* mesh)
    : stock_(stock),
      mesh_(mesh != nullptr ? std::make_unique<StockMesh>(*mesh) : nullptr),
      reach_mm_(reach_mm) {
  for (const auto& [id, tool] : tools) profiles_.emplace(id, ToolProfile(tool.tool));
  std::vector<Box> boxes;
  boxes.reserve(motions.size());
  sweeps_.reserve(motions.size());
  for (const ProgramMotion& motion : motions) {
    const Tool& tool = tools.at(motion.tool).tool;
    const ToolMotion m =
        make_motion({motion.from.tip_mm, normalized(motion.from.axis)},
                    {motion.to.tip_mm, normalized(motion.to.axis)}, tool.length_mm);
    sweeps_.push_back({&profiles_.at(motion.tool), m.from, m.to, m.turn_rad, m.travel_mm});
    boxes.push_back(sweeps_.back().bounds(tool.length_mm, tool.radius_mm));
  }
  tree_ = BoxTree(std::move(boxes), kMotionsPerRun);
}

TrueSolid::Signed TrueSolid::from_stock(Vec3 point, double limit_mm) const {
  if (mesh_) {
    const StockMesh::Nearest nearest = mesh_->nearest(point, limit_mm);
    return {nearest.mm, nearest.outward};
  }
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

bool TrueSolid::is_solid(Vec3 point, QueryEffort* effort) const {
  const bool stock = mesh_ ? mesh_->contains(point) : from_stock(point).mm < 0;
  return stock && is_clear(point, 0, effort);
}

TrueSolid::Nearest TrueSolid::nearest(Vec3 point, double limit_mm, double enough_mm,
                                      const std::stop_token& stop, QueryEffort* effort) const {
  Nearest found{sweeps_.size(), {0, limit_mm}};
  double limit = limit_mm;
  tree_.visit_nearest(point, limit, [&](std::uint32_t n) {
    const NearestPose pose = nearest_pose(sweeps_[n], point, found.pose, enough_mm);
    if (pose.mm < found.pose.mm) found = {n, pose};
    if (effort != nullptr && !effort->spent()) --effort->left;
    const bool done = found.pose.mm < enough_mm || stop.stop_requested() ||
                      (effort != nullptr && effort->spent());
    limit = done ? -std::numeric_limits<double>::infinity() : found.pose.mm;
  });
  return found;
}

TrueSolid::Signed TrueSolid::from_cuts(Vec3 point, const std::stop_token& stop,
                                       QueryEffort* effort) const {
  const auto [n, pose] =
      nearest(point, reach_mm_, -std::numeric_limits<double>::infinity(), stop, effort);
  if (n == sweeps_.size()) return {reach_mm_, {0, 0, 1}};
  return {pose.mm, outward_of(*sweeps_[n].profile, sweeps_[n].at(pose.share), point)};
}

bool TrueSolid::is_clear(Vec3 point, double radius_mm, QueryEffort* effort) const {
  return nearest(point, radius_mm, radius_mm, {}, effort).sweep == sweeps_.size();
}

std::size_t TrueSolid::nearest_sweep(Vec3 point) const {
  return nearest(point, reach_mm_, -std::numeric_limits<double>::infinity(), {}, nullptr).sweep;
}

TrueSolid::Distance TrueSolid::distance(Vec3 point, const std::stop_token& stop) const {
  const Signed stock = from_stock(point);
  const Signed first_cuts = from_cuts(point, stop);
  if (stock.mm <= 0 && first_cuts.mm >= 0)
    return {std::min(-stock.mm, first_cuts.mm), first_cuts.mm < -stock.mm};
  // Outside the solid: moves the point out of the sweep that contains it deepest until no sweep
  // contains it.
  const bool cut = -first_cuts.mm > stock.mm;
  Vec3 at = point;
  Signed from = stock, cuts = first_cuts;
  double left = std::max(from.mm, -cuts.mm);
  const double at_least = left;
  for (int step = 0; step < kStepsMax && left > kFoundMm && !stop.stop_requested(); ++step) {
    at = -cuts.mm > from.mm ? at - cuts.outward * cuts.mm : at - from.outward * from.mm;
    from = from_stock(at);
    cuts = from_cuts(at, stop);
    left = std::max(from.mm, -cuts.mm);
  }
  return {std::max(at_least, length(at - point) + std::max(0.0, left)), cut};
}

}  // namespace kerf
