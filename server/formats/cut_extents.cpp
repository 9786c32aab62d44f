// SPDX-License-Identifier: Apache-2.0
#include "server/formats/cut_extents.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// 1 less the cosine of the angle by which a retraction may lean from the tool's axis.
constexpr double kLean = 1e-6;
/// Z differences below this are rounding, mm.
constexpr double kLevelMm = 1e-6;
/// Feeds that climb or fall are entries into the material, unless they exceed this share of the
/// path above Z 0. Then they follow a surface.
constexpr double kSurfaceShare = 0.2;
constexpr double kTableShare = 0.5;

bool is_retraction(const ProgramMotion& motion) {
  const Vec3 path = motion.to.tip_mm - motion.from.tip_mm;
  return dot(path, motion.to.axis) >= length(path) * (1 - kLean);
}

}  // namespace

void CutExtentsFinder::look(const ProgramMotion& motion) {
  highest_ = std::max({highest_, motion.from.tip_mm.z, motion.to.tip_mm.z});
  if (!motion.rapid) lowest_ = std::min(lowest_, motion.to.tip_mm.z);
}

void CutExtentsFinder::add(const ProgramMotion& motion) {
  const Vec3 from = motion.from.tip_mm, to = motion.to.tip_mm;
  const double rise = to.z - from.z;
  const bool upright = motion.from.axis.z == 1 && motion.to.axis.z == 1;
  if (!(motion.from.tip_mm == last_mm_))
    in_air_ = lowest_ < highest_ && from.z >= highest_ - kLevelMm;
  last_mm_ = to;
  if (motion.rapid || is_retraction(motion)) {
    if (std::abs(rise) > kLevelMm) in_air_ = rise > 0;
    return;
  }
  if (upright && in_air_ && rise >= -kLevelMm) return;
  in_air_ = false;
  extend(to);
  extend({from.x, from.y, to.z});  // a rapid may have plunged to here
  const double sideways = std::hypot(to.x - from.x, to.y - from.y);
  if (sideways == 0) return;
  path_mm_ += sideways;
  if (std::max(from.z, to.z) > kLevelMm) above_mm_ += sideways;
  if (std::abs(rise) <= kLevelMm) {
    level_ = std::max(level_, to.z);
  } else {
    slope_ = std::max(slope_, to.z);
    if (from.z + to.z > 0) slope_mm_ += sideways;
  }
}

std::optional<CutExtents> CutExtentsFinder::result() const {
  if (!(box_.min_mm.x <= box_.max_mm.x)) return std::nullopt;
  CutExtents extents{.tip_mm = box_, .top_mm = level_};
  if (slope_mm_ > kSurfaceShare * path_mm_) extents.top_mm = std::max(level_, slope_);
  if (box_.min_mm.z < 0) extents.top_mm = std::max(extents.top_mm, 0.0);
  if (!std::isfinite(extents.top_mm)) extents.top_mm = box_.max_mm.z;
  extents.zero_at_table = above_mm_ > kTableShare * path_mm_;
  return extents;
}

void CutExtentsFinder::extend(Vec3 tip) {
  box_.min_mm = {std::min(box_.min_mm.x, tip.x), std::min(box_.min_mm.y, tip.y),
                 std::min(box_.min_mm.z, tip.z)};
  box_.max_mm = {std::max(box_.max_mm.x, tip.x), std::max(box_.max_mm.y, tip.y),
                 std::max(box_.max_mm.z, tip.z)};
}

}  // namespace kerf
