// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/clip_to_block.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/math/tolerance.h"
#include "kernel/piece/bounds.h"

namespace kerf {

std::optional<ToolPiece> clip_to_block(const ToolPiece& piece, const ToolMotion& m,
                                       const SweepBounds& block) {
  const Extent whole = extent(piece);
  double reach = std::numeric_limits<double>::infinity();
  // `u` and `tip` are the least components of the axis and the tip along one of the six outward
  // directions of the block, and `limit` is the block's greatest. On a great circle on the upper
  // side of a plane, the axis leans most at one end of the motion, and the tip is lowest at one
  // end.
  const auto clip = [&](double u, double tip, double limit) {
    if (!(u > 0)) return;
    reach = std::min(reach, (limit - tip + disc_half_width(whole.radius_mm, u)) / u);
  };
  const ToolPose &a = m.from, &b = m.to;
  for (const auto c : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    clip(std::min(a.axis.*c, b.axis.*c), std::min(a.tip_mm.*c, b.tip_mm.*c), block.max_mm.*c);
    clip(-std::max(a.axis.*c, b.axis.*c), -std::max(a.tip_mm.*c, b.tip_mm.*c), -block.min_mm.*c);
  }
  if (reach <= whole.z0_mm) return std::nullopt;
  const double needed = reach + kClipMarginShare * (whole.z1_mm - whole.z0_mm);
  if (std::holds_alternative<BallPiece>(piece) || !(needed < whole.z1_mm)) return piece;
  return slice_of(piece, whole.z0_mm, needed);
}

}  // namespace kerf
