// SPDX-License-Identifier: Apache-2.0
#include "server/carve/thin_walls.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

namespace kerf {
namespace {

// A ball that is smaller than required by this fraction fits.
constexpr double kBallSlack = 0.02;
// The sides of a wall face each other: least cosine of the angle between them. It is that of the
// sharpest edge into which a ball fits within a pitch of the tip.
constexpr double kFacingMin = 0.77;
// Moves of the ball away from what it touches.
constexpr int kMovesMax = 24;
// Between sides that are nearly parallel no ball fits farther on: least sine of the angle between
// them.
constexpr double kOpeningMin = 0.1;
// Greatest distance of the true surface from the mesh: 1.5 of that from a ball of a pitch's
// diameter inside the solid + 0.5 pitches (measured at edges of 20 to 90 degrees).
constexpr double kErrorPerReach = 1.5, kMeshPitches = 0.5;
constexpr double kPitchStep = 1.1;
// Least step through a wall, in pitches.
constexpr double kStepPitches = 1.0 / 64;
constexpr int kHalvings = 20;
// Directions across the rays, and in how many of them a solid that rays meet continues for a pitch:
// a wall does in at most 6, a web also at its border.
constexpr int kDirections = 16, kSeenDirections = 7;

double middle_z_mm(const StockShape& stock) {
  if (const auto* box = std::get_if<BoxStock>(&stock)) return (box->min_mm.z + box->max_mm.z) / 2;
  const auto& cylinder = std::get<CylinderStock>(stock);
  return (cylinder.min_z_mm + cylinder.max_z_mm) / 2;
}

class Prober {
 public:
  // `reach_mm`: distance from a point within which the ball must fit.
  Prober(const TrueSolid& solid, const ThinWallLimits& limits, double reach_mm, QueryEffort* effort)
      : solid_(solid),
        limits_(limits),
        reach_mm_(reach_mm),
        effort_(effort),
        middle_z_mm_(middle_z_mm(solid.stock())) {}

  // Whether the solid at a point may fall between the rays.
  bool is_thin(const CutPoint& point, double& thickness, Vec3& middle) const {
    if (is_thick(point)) return false;
    thickness = thickness_at(point);
    middle = point.mm + point.into_solid * (thickness / 2);
    const bool thin = thickness >= limits_.least_mm && !is_seen_along_z(middle);
    return thin && (effort_ == nullptr || !effort_->spent());
  }

  // The wall at a point, if it is thin and its sides face each other.
  std::optional<ThinWall> probe(const CutPoint& point) const {
    double thickness = 0;
    Vec3 middle;
    if (!is_thin(point, thickness, middle) || thickness > limits_.pitch_mm) return std::nullopt;
    const Vec3 beyond = point.mm + point.into_solid * (thickness + kStepPitches * limits_.pitch_mm);
    const TrueSolid::Signed stock = solid_.from_stock(beyond), cuts = solid_.from_cuts(beyond);
    const bool at_border = stock.mm >= 0 && stock.mm >= -cuts.mm;
    const Vec3 facing = at_border ? -stock.outward : cuts.outward;
    if (-dot(facing, point.into_solid) < kFacingMin) return std::nullopt;
    const std::size_t other = at_border ? solid_.sweeps().size() : solid_.nearest_sweep(beyond);
    const auto [first, second] = std::minmax({point.sweep, static_cast<std::uint32_t>(other)});
    return ThinWall{middle, thickness, first, second};
  }

 private:
  // Whether a ball fits: it starts touching the point and is moved away from what it overlaps.
  bool is_thick(const CutPoint& point) const {
    const double radius = limits_.pitch_mm / 2, enough = radius * (1 - kBallSlack);
    Vec3 center = point.mm + point.into_solid * radius;
    Vec3 before = point.into_solid;
    for (int move = 0; move < kMovesMax; ++move) {
      const TrueSolid::Signed stock = from_sides(center, radius);
      if (-stock.mm >= enough && solid_.is_clear(center, enough, effort_)) return true;
      // Away from what is nearest, along what was nearest before.
      TrueSolid::Signed space{-stock.mm, -stock.outward};
      if (space.mm >= enough) space = solid_.from_cuts(center, {}, effort_);
      const double facing = dot(before, space.outward);
      const Vec3 along = space.outward - before * facing;
      const double opening = length(along);
      if (opening < kOpeningMin && facing < 0) return false;
      center =
          center + (opening < kOpeningMin ? space.outward * (radius - space.mm)
                                          : along * ((radius - space.mm) / (opening * opening)));
      before = space.outward;
      // The ball's surface is nearer to the point than its center by the radius.
      if (length(center - point.mm) > reach_mm_ + radius) return false;
    }
    return false;
  }

  // The signed distance from the sides of the stock: its top and bottom are seen by the rays along
  // Z.
  TrueSolid::Signed from_sides(Vec3 p, double radius) const {
    const TrueSolid::Signed stock = solid_.from_stock({p.x, p.y, middle_z_mm_});
    return stock.outward.z != 0 ? TrueSolid::Signed{-2 * radius, stock.outward} : stock;
  }

  bool is_solid(Vec3 p) const {
    return solid_.from_stock(p).mm < 0 && solid_.is_clear(p, 0, effort_);
  }

  // Distance to the other side along the normal; more than a pitch if there is none within that.
  double thickness_at(const CutPoint& point) const {
    const double step = kStepPitches * limits_.pitch_mm;
    double inside = step / 2;
    while (inside <= limits_.pitch_mm && is_solid(point.mm + point.into_solid * inside))
      inside += step;
    if (inside > limits_.pitch_mm) return inside;
    double outside = inside;
    inside -= step;
    for (int n = 0; n < kHalvings; ++n) {
      const double middle = (inside + outside) / 2;
      (is_solid(point.mm + point.into_solid * middle) ? inside : outside) = middle;
    }
    return outside;
  }

  // Whether rays along Z around a point meet the solid at its height.
  bool is_seen_along_z(Vec3 point) const {
    int seen = 0;
    for (int n = 0; n < kDirections; ++n) {
      const double angle = 2 * std::numbers::pi * n / kDirections;
      const Vec3 beside{std::cos(angle), std::sin(angle), 0};
      if (is_solid(point + beside * limits_.pitch_mm)) ++seen;
    }
    return seen >= kSeenDirections;
  }

  const TrueSolid& solid_;
  ThinWallLimits limits_;
  double reach_mm_;
  QueryEffort* effort_;
  double middle_z_mm_;
};

// Whether a column within a pitch is solid at the point's height.
bool has_solid_near(const DexelSnapshot& field, Vec3 point) {
  const DexelGrid& grid = field.grid();
  const auto column = [&](double mm) {
    return static_cast<std::int32_t>(std::floor(mm / grid.pitch_mm));
  };
  const std::int32_t i = column(point.x - grid.origin_mm.x), j = column(point.y - grid.origin_mm.y);
  std::vector<Dexel> scratch;
  for (std::int32_t b = j - 1; b <= j + 1; ++b)
    for (std::int32_t a = i - 1; a <= i + 1; ++a)
      for (const Dexel& dexel : field.column(a, b, scratch))
        if (grid.z_mm(dexel.bottom) <= point.z && point.z <= grid.z_mm(dexel.top) &&
            std::hypot(grid.x_mm(a) - point.x, grid.y_mm(b) - point.y) < grid.pitch_mm)
          return true;
  return false;
}

}  // namespace

std::vector<ThinWall> find_thin_walls(const TrueSolid& solid, const CutSurface& surface,
                                      const ThinWallLimits& limits, const std::stop_token& stop,
                                      QueryEffort* effort) {
  const Prober prober(solid, limits, limits.pitch_mm, effort);
  std::vector<ThinWall> walls;
  for (const CutPoint& point : surface.points) {
    if (stop.stop_requested() || (effort != nullptr && effort->spent())) break;
    if (const auto wall = prober.probe(point)) walls.push_back(*wall);
  }
  std::ranges::stable_sort(walls, {}, &ThinWall::thickness_mm);
  return walls;
}

std::optional<double> pitch_for_walls(const TrueSolid& solid, const CutSurface& surface,
                                      const WallTarget& target, const std::stop_token& stop,
                                      QueryEffort* effort) {
  double pitch = target.pitch_mm;
  for (const CutPoint& point : surface.points) {
    double thickness = 0;
    Vec3 middle;
    while (!stop.stop_requested() &&
           Prober(solid, {pitch, target.least_mm},
                  (target.target_mm - kMeshPitches * pitch) / kErrorPerReach, effort)
               .is_thin(point, thickness, middle)) {
      pitch /= kPitchStep;
      if (pitch < target.pitch_mm * kFinestWallShare) return std::nullopt;
    }
  }
  return pitch;
}

std::vector<ThinWall> distinct_walls(const std::vector<ThinWall>& walls,
                                     const std::vector<std::uint64_t>& place_of_sweep) {
  const auto place = [&](std::uint32_t sweep) {
    return sweep < place_of_sweep.size() ? place_of_sweep[sweep] : UINT64_MAX;
  };
  std::set<std::pair<std::uint64_t, std::uint64_t>> seen;
  std::vector<ThinWall> distinct;
  for (const ThinWall& wall : walls)
    if (seen.insert(std::minmax({place(wall.sweep), place(wall.other_sweep)})).second)
      distinct.push_back(wall);
  return distinct;
}

void mark_missing(std::vector<ThinWall>& walls, const DexelSnapshot& before,
                  const DexelSnapshot& after) {
  std::erase_if(walls, [&](const ThinWall& wall) { return !has_solid_near(before, wall.mm); });
  for (ThinWall& wall : walls) wall.missing = !has_solid_near(after, wall.mm);
}

}  // namespace kerf
