// SPDX-License-Identifier: Apache-2.0
#include "kernel/motion_reach.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "kernel/dexel/tile_region.h"
#include "kernel/sculpture_motion.h"

namespace kerf {
namespace {

/// Number of tiles of one field from which on a motion is divided.
constexpr std::int64_t kTilesUndivided = 16;
/// Greatest number of divisions of a motion into halves.
constexpr int kDepthMax = 12;

/// A tool of more pieces is bounded by one cylinder.
constexpr std::size_t kPiecesBounded = 8;

/// Returns a box around the path of the point of the axis at a height above the tip. Each
/// coordinate is a sine of the angle, so it leaves the line between its ends by at most an eighth
/// of its greatest second derivative.
Bounds swept_point(double height_mm, const ToolMotion& motion) {
  const Vec3 first = motion.from.tip_mm + motion.from.axis * height_mm;
  const Vec3 last = motion.to.tip_mm + motion.to.axis * height_mm;
  return grown(joined({first, first}, {last, last}),
               std::abs(height_mm) * motion.turn_rad * motion.turn_rad / 8);
}

/// Returns the greatest support of a disc along a direction while its normal turns by less than 180
/// degrees. The arguments are the components of the normal at both ends. If both have one sign, the
/// component in between is nowhere nearer to 0 than at an end.
double turning_half_width(double radius_mm, double first, double last) {
  if (first * last <= 0 && first != last) return radius_mm;
  return std::max(disc_half_width(radius_mm, first), disc_half_width(radius_mm, last));
}

/// Returns a box around the volume that a disc across the axis passes.
Bounds swept_disc(double height_mm, double radius_mm, const ToolMotion& motion) {
  const Vec3 first = motion.from.axis, last = motion.to.axis;
  const Vec3 half{turning_half_width(radius_mm, first.x, last.x),
                  turning_half_width(radius_mm, first.y, last.y),
                  turning_half_width(radius_mm, first.z, last.z)};
  const Bounds center = swept_point(height_mm, motion);
  return {center.lo_mm - half, center.hi_mm + half};
}

Bounds swept_cylinder(const Extent& whole, const ToolMotion& motion) {
  return joined(swept_disc(whole.z0_mm, whole.radius_mm, motion),
                swept_disc(whole.z1_mm, whole.radius_mm, motion));
}

struct SweptBox {
  const ToolMotion& motion;
  Bounds operator()(const BallPiece& ball) const {
    return grown(swept_point(ball.center_mm, motion), ball.radius_mm);
  }
  Bounds operator()(const FrustumPiece& p) const {
    return joined(swept_disc(p.z0_mm, p.r0_mm, motion), swept_disc(p.z1_mm, p.r1_mm, motion));
  }
  Bounds operator()(const ArcPiece& arc) const {
    const Bounds cylinder = swept_cylinder(extent(arc), motion);
    if (arc.center_r_mm < 0) return cylinder;
    // Every point of the arc is within its radius of the disc that its center sweeps.
    return common(cylinder,
                  grown(swept_disc(arc.center_z_mm, arc.center_r_mm, motion), arc.radius_mm));
  }
};

/// Returns a box around the volume that pieces of a tool, at least one, pass.
Bounds swept_box(std::span<const ToolPiece> pieces, const Extent& whole, const ToolMotion& motion) {
  if (pieces.size() > kPiecesBounded) return swept_cylinder(whole, motion);
  Bounds box = std::visit(SweptBox{motion}, pieces.front());
  for (const ToolPiece& piece : pieces.subspan(1)) {
    box = joined(box, std::visit(SweptBox{motion}, piece));
  }
  return box;
}

void add_reach(const Tool& tool, const ToolMotion& motion, const DexelGrid& grid, double margin_mm,
               int depth, std::vector<FieldTile>& tiles) {
  const Bounds box = grown(reach_of(tool, motion), margin_mm);
  const TileRegion region = tiles_through(grid, box.lo_mm, box.hi_mm);
  if (region.count() > kTilesUndivided && depth < kDepthMax) {
    // Halves that are shorter than the tool is wide reach the same tiles.
    const double half_mm = motion.travel_mm / 2;
    if (half_mm > tool.radius_mm && half_mm > kTileSide * grid.pitch_mm) {
      const ToolPose middle = motion.at(0.5);
      for (const auto& [from, to] : {std::pair{motion.from, middle}, {middle, motion.to}}) {
        add_reach(tool, make_motion(from, to, tool.length_mm), grid, margin_mm, depth + 1, tiles);
      }
      return;
    }
  }
  region.all_of([&](TileIndex tile) {
    tiles.push_back({grid.axis, tile});
    return true;
  });
}

/// An axis that rises less is not clipped at a box, because it has many heights there.
constexpr double kRiseMin = 0.25;

/// Returns the square of the distance of two boxes, mm².
double distance2(const Bounds& a, const Bounds& b) {
  const auto gap = [](double a_lo, double a_hi, double b_lo, double b_hi) {
    return std::max({0.0, b_lo - a_hi, a_lo - b_hi});
  };
  const Vec3 d{gap(a.lo_mm.x, a.hi_mm.x, b.lo_mm.x, b.hi_mm.x),
               gap(a.lo_mm.y, a.hi_mm.y, b.lo_mm.y, b.hi_mm.y),
               gap(a.lo_mm.z, a.hi_mm.z, b.lo_mm.z, b.hi_mm.z)};
  return dot(d, d);
}

/// Returns whether a part of a tool with this extent may enter a box. While the axis rises, a disc
/// of it leaves its height by at most the radius times the sine of the tilt.
bool may_meet(Extent part, const ToolMotion& motion, const Bounds& box) {
  const double rise = std::min(motion.from.axis.z, motion.to.axis.z);
  if (rise > kRiseMin) {
    const double low = std::min(motion.from.tip_mm.z, motion.to.tip_mm.z);
    const double high = std::max(motion.from.tip_mm.z, motion.to.tip_mm.z);
    const double edge = disc_half_width(part.radius_mm, rise);
    part.z0_mm = std::max(part.z0_mm, box.lo_mm.z - edge - high);
    part.z1_mm = std::min(part.z1_mm, (box.hi_mm.z + edge - low) / rise);
    if (part.z0_mm > part.z1_mm) return false;
  }
  const Bounds spine = joined(swept_point(part.z0_mm, motion), swept_point(part.z1_mm, motion));
  return distance2(spine, box) <= part.radius_mm * part.radius_mm;
}

}  // namespace

bool may_meet(const Tool& tool, const ToolMotion& motion, const Bounds& box) {
  if (tool.pieces.size() > kPiecesBounded) {
    return may_meet(Extent{0, tool.length_mm, tool.radius_mm}, motion, box);
  }
  return std::ranges::any_of(tool.pieces, [&](const ToolPiece& piece) {
    if (const auto* ball = std::get_if<BallPiece>(&piece)) {
      const Bounds centers = swept_point(ball->center_mm, motion);
      return distance2(centers, box) <= ball->radius_mm * ball->radius_mm;
    }
    return may_meet(extent(piece), motion, box);
  });
}

Bounds reach_of(const Tool& tool, const ToolMotion& motion) {
  return swept_box(tool.pieces, {0, tool.length_mm, tool.radius_mm}, motion);
}

Bounds non_cutting_reach(const Tool& tool, const ToolMotion& motion) {
  const Extent first = extent(tool.non_cutting.front());
  return swept_box(tool.non_cutting, {first.z0_mm, tool.whole_length_mm, tool.whole_radius_mm},
                   motion);
}

Bounds reach_of(const Tool& tool, const MoveTool& motion) {
  return reach_of(tool, motion_of(motion, tool));
}

void find_reach(const Tool& tool, const MoveTool& motion, std::span<const DexelGrid> grids,
                double tolerance_mm, std::vector<FieldTile>& tiles) {
  find_reach(tool, motion_of(motion, tool), grids, tolerance_mm, tiles);
}

void find_reach(const Tool& tool, const ToolMotion& motion, std::span<const DexelGrid> grids,
                double tolerance_mm, std::vector<FieldTile>& tiles) {
  tiles.clear();
  for (const DexelGrid& grid : grids) {
    // Ends are rounded to a quantum, and are within the tolerance of the true sweep.
    add_reach(tool, motion, grid, tolerance_mm + grid.z_quantum_mm, 0, tiles);
  }
  std::ranges::sort(tiles);
  tiles.erase(std::ranges::unique(tiles).begin(), tiles.end());
}

}  // namespace kerf
