// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/tool_above.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Least vertical component of the axis.
constexpr double kAxisUprightMin = 0.3;

/// The height up to which a piece widens, or is a cylinder, and its radius there.
struct Foot {
  double z, radius;
};

Foot foot_of(const ToolPiece& piece) {
  const Extent e = extent(piece);
  if (const auto* f = std::get_if<FrustumPiece>(&piece)) {
    return f->r1_mm >= f->r0_mm ? Foot{e.z1_mm, f->r1_mm} : Foot{e.z0_mm, f->r0_mm};
  }
  const auto* ball = std::get_if<BallPiece>(&piece);
  const double center = ball != nullptr ? ball->center_mm : std::get<ArcPiece>(piece).center_z_mm;
  const double z = std::clamp(center, e.z0_mm, e.z1_mm);
  return {z, radius_at(piece, z)};
}

/// Returns the height up to which the tool is nowhere thinner than at the foot of one of its
/// pieces.
double height_above(const Tool& tool, std::size_t which, Foot foot) {
  double high = foot.z;
  for (std::size_t k = which; k < tool.pieces.size(); ++k) {
    const Extent e = extent(tool.pieces[k]);
    if (e.z1_mm <= high) continue;
    // The radius of a convex piece is least at one of the two heights.
    const double least = e.z0_mm > high + kEdgeEpsilonMm
                             ? kNoRadiusMm
                             : std::min(radius_at(tool.pieces[k], std::max(high, e.z0_mm)),
                                        radius_at(tool.pieces[k], e.z1_mm));
    if (least >= foot.radius * (1 - kHiddenDiscShare) - kEdgeEpsilonMm) high = e.z1_mm;
  }
  return high;
}

KERF_INLINE LaneMask is_inside(const ToolAbove::Pose& pose, double low, double high, double radius,
                               Lanes x, Lanes y) {
  const Lanes px = x - pose.x, py = y - pose.y;
  const Lanes l = px * pose.axis.x + py * pose.axis.y + pose.z * pose.axis.z;
  const Lanes rho2 = px * px + py * py + pose.z * pose.z - l * l;
  return (l >= low) & (l <= high) & (rho2 <= radius * radius);
}

KERF_INLINE void find_in_lanes(const ToolAbove::Pose* poses, double low, double high, double radius,
                               ColumnBlock& block) {
  for (int row = 0; row < kBlockSide; ++row) {
    if ((block.rows >> row & 1) == 0) continue;
    const Lanes y = Lanes(block.y_mm[row]);
    const LaneMask inside = is_inside(poses[0], low, high, radius, block.x_mm, y) &
                            is_inside(poses[1], low, high, radius, block.x_mm, y);
    block.raised[row] = inside;
    if (any(inside)) block.raised_rows |= 1U << row;
  }
}
KERF_FOR_EACH_TARGET(void, find,
                     (const ToolAbove::Pose* poses, double low, double high, double radius,
                      ColumnBlock& block),
                     (poses, low, high, radius, block))

}  // namespace

ToolAbove::ToolAbove(const Tool& tool, std::size_t which, const ToolMotion& motion, double top_mm) {
  const ToolPose &a = motion.from, &b = motion.to;
  if (!(std::min(a.axis.z, b.axis.z) > kAxisUprightMin)) return;
  const Foot foot = foot_of(tool.pieces[which]);
  const double high = height_above(tool, which, foot);
  // Relative to the tool a point leaves its chord between the two poses by at most an eighth of its
  // greatest acceleration (kernel/sweep/bounds.md, "Below a tool").
  const double turn = motion.turn_rad, reach = std::sqrt(high * high + foot.radius * foot.radius);
  const double bend = turn * turn * (reach + motion.travel_mm) + 2 * turn * motion.travel_mm;
  const double margin = bend / 8 + kEdgeEpsilonMm;
  low_ = foot.z + margin;
  high_ = high - margin;
  if (!(low_ < high_)) return;
  radius_ = std::max(0.0, foot.radius - margin);
  poses_[0] = {a.tip_mm.x, a.tip_mm.y, top_mm - a.tip_mm.z, a.axis};
  poses_[1] = {b.tip_mm.x, b.tip_mm.y, top_mm - b.tip_mm.z, b.axis};
}

void ToolAbove::find_covered(ColumnBlock& block) const {
  find(poses_, low_, high_, radius_, block);
}

}  // namespace kerf
