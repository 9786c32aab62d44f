// SPDX-License-Identifier: Apache-2.0
#include "server/verify/cut_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "kernel/math/rotation.h"

namespace kerf {
namespace {

// A candidate is kept if a point this far outside its tool is in no other motion, mm.
constexpr double kOutsideMm = 1e-4;
// Every n-th candidate is at an end of its motion.
constexpr std::size_t kEndEvery = 4;
// Steps of the sequence that spreads points evenly over a cube, also any beginning of it (Roberts,
// The unreasonable effectiveness of quasirandom sequences, 2018).
constexpr double kAlong = 0.8191725133961645, kAcross = 0.6710436067037893,
                 kAround = 0.5497004779019703;

double fraction(double value) { return value - std::floor(value); }

std::array<Vec3, 8> corners_of(const StockShape& stock) {
  BoxStock box;
  if (const auto* plain = std::get_if<BoxStock>(&stock)) {
    box = *plain;
  } else {
    const auto& c = std::get<CylinderStock>(stock);
    box = {{c.center_x_mm - c.radius_mm, c.center_y_mm - c.radius_mm, c.min_z_mm},
           {c.center_x_mm + c.radius_mm, c.center_y_mm + c.radius_mm, c.max_z_mm}};
  }
  std::array<Vec3, 8> corners;
  for (unsigned n = 0; n < 8; ++n)
    corners[n] = {(n & 1) != 0 ? box.max_mm.x : box.min_mm.x,
                  (n & 2) != 0 ? box.max_mm.y : box.min_mm.y,
                  (n & 4) != 0 ? box.max_mm.z : box.min_mm.z};
  return corners;
}

// The part of a motion's surface that may be inside the stock.
struct SweptArea {
  double height_mm = 0;   // above the tip, up to which the tool may be in the stock
  double outline_mm = 0;  // length of the outline up to there
  double area_mm2 = 0;
  double until = 0;  // share of the candidates for this motion and all before
};

class Sampler {
 public:
  Sampler(const TrueSolid& solid, QueryEffort* effort)
      : solid_(solid), effort_(effort), corners_(corners_of(solid.stock())) {
    const std::span<const MovingTool> tools = solid.sweeps();
    for (std::size_t n = 0; n < tools.size(); ++n) {
      const MovingTool& tool = tools[n];
      SweptArea& swept = areas_.emplace_back();
      for (const Vec3 corner : corners_)
        for (const ToolPose& pose : {tool.from, tool.to})
          swept.height_mm = std::max(swept.height_mm, dot(corner - pose.tip_mm, pose.axis));
      swept.outline_mm = tool.profile->outline_length(swept.height_mm);
      // Both sides. A free end counts as a step of the tool's radius.
      double path = tool.travel_mm + tool.turn_rad * swept.height_mm;
      if (n == 0 || tools[n - 1].to != tool.from) path += tool.profile->radius_mm();
      if (n + 1 == tools.size() || tools[n + 1].from != tool.to) path += tool.profile->radius_mm();
      if (swept.outline_mm > 0 && is_in_reach(tool, swept))
        swept.area_mm2 = 2 * swept.outline_mm * path;
    }
    share_between_tools();
  }

  // Greatest area for a candidate, times their number.
  double area_mm2() const { return area_mm2_ / least_density_; }

  // Appends the points of candidate `n` that are on the surface.
  void add(std::size_t n, std::vector<CutPoint>& points) const {
    const double at = fraction((double(n) + 0.5) * kAlong);
    const auto swept = std::ranges::upper_bound(areas_, at, {}, &SweptArea::until);
    if (swept == areas_.end()) return;
    const auto index = static_cast<std::uint32_t>(swept - areas_.begin());
    const double before = index == 0 ? 0 : areas_[index - 1].until;
    const double along = (at - before) / (swept->until - before);
    const auto outline = solid_.sweeps()[index].profile->outline_at(fraction(double(n) * kAcross) *
                                                                    swept->outline_mm);
    const double angle = 2 * std::numbers::pi * fraction(double(n) * kAround);
    if (n % kEndEvery == 0) {
      add_at({index, n / kEndEvery % 2 == 0 ? 0.0 : 1.0, outline}, angle, points);
    } else {
      add_grazing({index, along, outline}, angle, points);
    }
  }

 private:
  // A circle of the tool's surface at a pose.
  struct Circle {
    std::uint32_t sweep;
    double share;
    ToolProfile::OutlinePoint outline;
  };

  // With several tools, each gets half of its share by area and half of an equal share.
  void share_between_tools() {
    std::map<const ToolProfile*, double> of_tool;
    for (std::size_t n = 0; n < areas_.size(); ++n) {
      if (areas_[n].area_mm2 == 0) continue;
      of_tool[solid_.sweeps()[n].profile] += areas_[n].area_mm2;
      area_mm2_ += areas_[n].area_mm2;
    }
    if (of_tool.size() > 1) least_density_ = 0.5;
    double until = 0;
    for (std::size_t n = 0; n < areas_.size(); ++n) {
      SweptArea& swept = areas_[n];
      if (swept.area_mm2 > 0) {
        const double of_all = swept.area_mm2 / area_mm2_;
        const double of_same =
            swept.area_mm2 / of_tool.at(solid_.sweeps()[n].profile) / double(of_tool.size());
        until += (of_all + of_same) / 2;
      }
      swept.until = until;
    }
  }

  bool is_in_reach(const MovingTool& tool, const SweptArea& swept) const {
    const Box box = tool.bounds(swept.height_mm, tool.profile->radius_mm());
    Box stock{corners_[0], corners_[7]};
    return box.low.x < stock.high.x && box.low.y < stock.high.y && box.low.z < stock.high.z &&
           box.high.x > stock.low.x && box.high.y > stock.low.y && box.high.z > stock.low.z;
  }

  // Finds where the normal is perpendicular to the velocity: A cos(angle) + B sin(angle) + C = 0.
  // If every angle solves it, uses the given one. If none does, the surface is that of an end.
  void add_grazing(Circle circle, double angle, std::vector<CutPoint>& points) const {
    const MovingTool& tool = solid_.sweeps()[circle.sweep];
    const auto& [r, h, nr, nh] = circle.outline;
    const Vec3 axis = tool.at(circle.share).axis;
    const Vec3 e1 = any_perpendicular(axis), e2 = cross(axis, e1);
    const Vec3 travel = tool.to.tip_mm - tool.from.tip_mm;
    const Vec3 turn = tool.turn_rad > 0
                          ? normalized(cross(tool.from.axis, tool.to.axis)) * tool.turn_rad
                          : Vec3{};
    const double lever = r * nh - h * nr;
    const double a = nr * dot(travel, e1) - lever * dot(turn, e2);
    const double b = nr * dot(travel, e2) + lever * dot(turn, e1);
    const double c = nh * dot(travel, axis);
    const double size = std::hypot(a, b), whole = tool.travel_mm + tool.turn_rad * (r + h);
    if (std::abs(c) > size * (1 + 1e-9) + 1e-9 * whole) {
      circle.share = circle.share < 0.5 ? 0 : 1;
      add_at(circle, angle, points);
    } else if (size <= 1e-9 * whole) {
      add_at(circle, angle, points);
    } else {
      const double middle = std::atan2(b, a);
      const double to = std::acos(std::clamp(-c / size, -1.0, 1.0));
      add_at(circle, middle + to, points);
      add_at(circle, middle - to, points);
    }
  }

  void add_at(const Circle& circle, double angle, std::vector<CutPoint>& points) const {
    const ToolPose pose = solid_.sweeps()[circle.sweep].at(circle.share);
    const Vec3 e1 = any_perpendicular(pose.axis), e2 = cross(pose.axis, e1);
    const Vec3 radial = e1 * std::cos(angle) + e2 * std::sin(angle);
    const auto& [r, h, nr, nh] = circle.outline;
    const CutPoint point{pose.tip_mm + radial * r + pose.axis * h, radial * nr + pose.axis * nh,
                         circle.sweep, circle.share};
    const Vec3 beside = point.mm + point.into_solid * kOutsideMm;
    if (solid_.from_stock(beside, 2 * kOutsideMm).mm < -kOutsideMm &&
        solid_.is_clear(beside, 0, effort_) && (effort_ == nullptr || !effort_->spent()))
      points.push_back(point);
  }

  const TrueSolid& solid_;
  QueryEffort* effort_;
  std::array<Vec3, 8> corners_;
  std::vector<SweptArea> areas_;
  double area_mm2_ = 0, least_density_ = 1;
};

// Appends candidate `n` of the stock's mesh if it is on the surface: not inside another body of the
// mesh, and in no cut.
void add_of_mesh(const TrueSolid& solid, std::size_t n, QueryEffort* effort,
                 std::vector<CutPoint>& points) {
  const StockMesh& mesh = *solid.mesh();
  const auto [mm, normal] = mesh.at(fraction((double(n) + 0.5) * kAlong) * mesh.area_mm2(),
                                    fraction(double(n) * kAcross), fraction(double(n) * kAround));
  const Vec3 over = mm + normal * kOutsideMm, under = mm - normal * kOutsideMm;
  const bool solid_over = mesh.contains(over);
  if (solid_over == mesh.contains(under) || !solid.is_clear(solid_over ? over : under, 0, effort))
    return;
  if (effort != nullptr && effort->spent()) return;
  points.push_back(
      {mm, solid_over ? normal : -normal, static_cast<std::uint32_t>(solid.sweeps().size())});
}

}  // namespace

CutSurface sample_cut_surface(const TrueSolid& solid, std::size_t candidates,
                              const std::stop_token& stop, QueryEffort* effort) {
  const Sampler sampler(solid, effort);
  CutSurface surface;
  std::optional<QueryEffort> of_mesh;
  if (effort != nullptr) of_mesh = *effort;
  std::size_t n = 0;
  for (; n < candidates && !stop.stop_requested() && (effort == nullptr || !effort->spent()); ++n)
    sampler.add(n, surface.points);
  double area = sampler.area_mm2();
  if (solid.mesh() != nullptr) {
    for (std::size_t m = 0; m < candidates && !stop.stop_requested(); ++m)
      add_of_mesh(solid, m, of_mesh ? &*of_mesh : nullptr, surface.points);
    area = std::max(area, solid.mesh()->area_mm2());
  }
  surface.spacing_mm = std::sqrt(area / double(std::max<std::size_t>(n, 1)));
  return surface;
}

}  // namespace kerf
