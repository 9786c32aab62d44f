// SPDX-License-Identifier: Apache-2.0
#include "server/verify/wall_probe.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/math/rotation.h"

namespace kerf {
namespace {

using enum SurfaceSide;

// A ball smaller than required by this fraction still fits.
constexpr double kBallSlack = 0.02;
// The sides of a wall face each other: least cosine of the angle between them. It belongs to the
// sharpest edge into which a ball fits within a pitch of the tip.
constexpr double kFacingMin = 0.77;
// Least cosine of the angle between Z and the normal of a surface that rays along Z cross. A wall
// or groove is judged at its upright sides.
constexpr double kLevelMin = 0.77;
// Most moves of the ball away from overlaps.
constexpr int kMovesMax = 24;
// Between nearly parallel sides no ball fits farther on: least sine of the angle between them.
constexpr double kOpeningMin = 0.1;
// Least step through a wall, in pitches.
constexpr double kStepPitches = 1.0 / 64;
constexpr int kHalvings = 20;
// Directions across the rays, and the number of them in which a solid that rays meet continues for
// a pitch: at most 6 for a wall; more for a web, also at its border.
constexpr int kDirections = 16, kSeenDirections = 7;

double middle_z_mm(const StockShape& stock) {
  if (const auto* box = std::get_if<BoxStock>(&stock)) return (box->min_mm.z + box->max_mm.z) / 2;
  const auto& cylinder = std::get<CylinderStock>(stock);
  return (cylinder.min_z_mm + cylinder.max_z_mm) / 2;
}

Vec3 into(const CutPoint& point, SurfaceSide side) {
  return side == kSolid ? point.into_solid : -point.into_solid;
}

}  // namespace

WallProbe::WallProbe(const TrueSolid& solid, const ThinWallLimits& limits, double reach_mm,
                     QueryEffort* effort)
    : solid_(solid),
      limits_(limits),
      reach_mm_(reach_mm),
      radius_mm_(limits.pitch_mm / 2),
      effort_(effort),
      middle_z_mm_(middle_z_mm(solid.stock())) {}

std::optional<WallProbe::Thinness> WallProbe::thin_at(const CutPoint& point,
                                                      SurfaceSide side) const {
  if (std::abs(point.into_solid.z) >= kLevelMin || is_thick(point, side)) return std::nullopt;
  const Vec3 inward = into(point, side);
  const double thickness = thickness_at(point.mm, inward, side);
  const Vec3 middle = point.mm + inward * (thickness / 2);
  if (thickness < limits_.least_mm || is_seen_along_z(middle, side)) return std::nullopt;
  if (effort_ != nullptr && effort_->spent()) return std::nullopt;
  return Thinness{thickness, middle};
}

std::optional<ThinWall> WallProbe::wall_at(const CutPoint& point, SurfaceSide side) const {
  const auto thin = thin_at(point, side);
  if (!thin || thin->thickness_mm > limits_.pitch_mm) return std::nullopt;
  const Vec3 inward = into(point, side);
  const Vec3 beyond = point.mm + inward * (thin->thickness_mm + kStepPitches * limits_.pitch_mm);
  const TrueSolid::Signed stock = solid_.from_stock(beyond), cuts = solid_.from_cuts(beyond);
  // The crossed surface: in the void the deepest, in the solid the nearest.
  const bool at_border =
      side == kSolid ? stock.mm >= 0 && stock.mm >= -cuts.mm : stock.mm <= 0 && -stock.mm < cuts.mm;
  const Vec3 into_solid = at_border ? -stock.outward : cuts.outward;
  const double facing = dot(into_solid, point.into_solid);
  if (-facing < kFacingMin) return std::nullopt;
  const std::size_t other = at_border ? solid_.sweeps().size() : solid_.nearest_sweep(beyond);
  const auto [first, second] = std::minmax({point.sweep, static_cast<std::uint32_t>(other)});
  return ThinWall{.mm = thin->middle,
                  .thickness_mm = thin->thickness_mm,
                  .sweep = first,
                  .other_sweep = second,
                  .groove = side == kVoid};
}

bool WallProbe::is_thick(const CutPoint& point, SurfaceSide side) const {
  if (side == kSolid) return fits_in_solid(point) || fits_nearby(point, side);
  const bool cut = point.sweep < solid_.sweeps().size();
  if (cut && fits_in_tool(point)) return true;
  // Next to a box or a cylinder, which are convex, any ball fits.
  if (solid_.mesh() == nullptr && -solid_.from_stock(point.mm).mm <= reach_mm_) return true;
  return fits_nearby(point, side);
}

// Whether a ball fits. It starts at the point and is moved away from overlaps.
template <class SpaceAt>
bool WallProbe::fits_after_moves(const CutPoint& point, Vec3 inward, SpaceAt&& space_at) const {
  const double enough = radius_mm_ * (1 - kBallSlack);
  Vec3 center = point.mm + inward * radius_mm_;
  Vec3 before = inward;
  for (int move = 0; move < kMovesMax; ++move) {
    const Space space = space_at(center, enough);
    if (space.mm >= enough) return true;
    // Away from the nearest surface, along the previously nearest one.
    const double facing = dot(before, space.deeper);
    const Vec3 along = space.deeper - before * facing;
    const double opening = length(along);
    if (opening < kOpeningMin && facing < 0) return false;
    center =
        center + (opening < kOpeningMin ? space.deeper * (radius_mm_ - space.mm)
                                        : along * ((radius_mm_ - space.mm) / (opening * opening)));
    before = space.deeper;
    // The ball's surface is nearer to the point than its center by the radius.
    if (length(center - point.mm) > reach_mm_ + radius_mm_) return false;
  }
  return false;
}

bool WallProbe::fits_in_solid(const CutPoint& point) const {
  return fits_after_moves(point, point.into_solid, [this](Vec3 center, double enough) {
    const Space sides = from_sides(center);
    if (sides.mm < enough || solid_.is_clear(center, enough, effort_)) return sides;
    const TrueSolid::Signed cuts = solid_.from_cuts(center, {}, effort_);
    return Space{cuts.mm, cuts.outward};
  });
}

// Whether a ball fits into the tool at its contact with the point.
bool WallProbe::fits_in_tool(const CutPoint& point) const {
  const MovingTool& tool = solid_.sweeps()[point.sweep];
  const ToolPose pose = tool.at(point.share);
  return fits_after_moves(point, -point.into_solid, [&](Vec3 center, double) {
    const Vec3 p = center - pose.tip_mm;
    const double h = dot(p, pose.axis), r = length(p - pose.axis * h);
    return Space{-tool.profile->nearest(r, h).distance_mm,
                 -outward_of(*tool.profile, pose, center)};
  });
}

// Tries some balls, which may be in several cuts or bodies: some that touch the point's tangent
// plane, and one along the tool, because there is space below a low rib and above a shallow groove.
bool WallProbe::fits_nearby(const CutPoint& point, SurfaceSide side) const {
  const Vec3 inward = into(point, side);
  const Vec3 e1 = any_perpendicular(inward), e2 = cross(inward, e1);
  for (const double a : {0.0, 1.0, -1.0}) {
    for (const double b : {0.0, 1.0, -1.0}) {
      const Vec3 away = (inward + e1 * a + e2 * b) * radius_mm_;
      if (length(away) <= reach_mm_ + radius_mm_ && ball_fits(point.mm + away, side)) return true;
    }
  }
  const bool cut = point.sweep < solid_.sweeps().size();
  if (!cut) return false;
  const Vec3 axis = solid_.sweeps()[point.sweep].at(point.share).axis;
  const double away = (reach_mm_ + radius_mm_) * (side == kVoid ? 1 : -1);
  return ball_fits(point.mm + axis * away, side);
}

// Whether the center and 26 points of a ball's surface are on a side.
bool WallProbe::ball_fits(Vec3 center, SurfaceSide side) const {
  if (!is_on(center, side)) return false;
  const double radius = radius_mm_ * (1 - kBallSlack);
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, 0.0, 1.0}) {
        const Vec3 direction = normalized({x, y, z});
        if (direction != Vec3{} && !is_on(center + direction * radius, side)) return false;
      }
    }
  }
  return true;
}

// The depth below the sides of the stock. Rays along Z see the top and bottom of a box or a
// cylinder.
WallProbe::Space WallProbe::from_sides(Vec3 p) const {
  if (solid_.mesh() != nullptr) {
    const TrueSolid::Signed stock = solid_.from_stock(p, 2 * radius_mm_);
    return {-stock.mm, -stock.outward};
  }
  const TrueSolid::Signed stock = solid_.from_stock({p.x, p.y, middle_z_mm_});
  return stock.outward.z != 0 ? Space{2 * radius_mm_, -stock.outward}
                              : Space{-stock.mm, -stock.outward};
}

bool WallProbe::is_on(Vec3 p, SurfaceSide side) const {
  return solid_.is_solid(p, effort_) == (side == kSolid);
}

double WallProbe::thickness_at(Vec3 point, Vec3 inward, SurfaceSide side) const {
  const double step = kStepPitches * limits_.pitch_mm;
  double inside = step / 2;
  while (inside <= limits_.pitch_mm && is_on(point + inward * inside, side)) inside += step;
  if (inside > limits_.pitch_mm) return inside;
  double outside = inside;
  inside -= step;
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = (inside + outside) / 2;
    (is_on(point + inward * middle, side) ? inside : outside) = middle;
  }
  return outside;
}

// Whether rays along Z around a point meet its side of the surface at its height.
bool WallProbe::is_seen_along_z(Vec3 point, SurfaceSide side) const {
  int seen = 0;
  for (int n = 0; n < kDirections; ++n) {
    const double angle = 2 * std::numbers::pi * n / kDirections;
    const Vec3 beside{std::cos(angle), std::sin(angle), 0};
    if (is_on(point + beside * limits_.pitch_mm, side)) ++seen;
  }
  return seen >= kSeenDirections;
}

}  // namespace kerf
