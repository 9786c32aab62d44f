// SPDX-License-Identifier: Apache-2.0
#include "server/verify/cut_depth.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "kernel/sweep/tool_motion.h"
#include "server/verify/column_sets.h"

namespace kerf {
namespace {

/// Depths that exceed the deepest so far by less than this fraction of it, or of the pitch if that
/// is less, are not looked for.
constexpr double kAccuracyShare = 0.1;
/// Least distance between the samples of a removed element, as a fraction of the pitch.
constexpr double kSampleShare = 0.5;

MovingTool moving(const ToolProfile& profile, const Tool& tool, const ToolPose& from,
                  const ToolPose& to) {
  const ToolMotion motion = make_motion({from.tip_mm, normalized(from.axis)},
                                        {to.tip_mm, normalized(to.axis)}, tool.length_mm);
  return {&profile, motion.from, motion.to, motion.turn_rad, motion.travel_mm};
}

}  // namespace

CutDepth::CutDepth(const Tool& tool, const ToolPose& from, const ToolPose& to, double ignored_mm,
                   DexelSnapshot before, DexelSnapshot after, const std::vector<FieldTile>& cut,
                   const ConvexOutline* within)
    : profile_(tool),
      motion_(moving(profile_, tool, from, to)),
      ignored_mm_(ignored_mm),
      within_(within),
      rows_(std::move(before), std::move(after), cut) {}

double CutDepth::sought_mm() const {
  if (depth_mm_ <= ignored_mm_) return ignored_mm_;
  return depth_mm_ + kAccuracyShare * std::min(depth_mm_, rows_.after().grid().pitch_mm);
}

/// No point is deeper in a tool than its radius.
bool CutDepth::is_deepest() const { return sought_mm() >= profile_.radius_mm(); }

bool CutDepth::advance(std::size_t distances) {
  if (is_deepest()) return true;
  return rows_.advance(distances, [this](std::int32_t i, std::int32_t j) {
    const std::size_t before = distances_;
    measure(i, j);
    return distances_ - before;
  });
}

void CutDepth::measure(std::int32_t i, std::int32_t j) {
  const DexelGrid& grid = rows_.after().grid();
  if (is_deepest()) return;
  if (within_ != nullptr && !within_->contains(grid.x_mm(i), grid.y_mm(j))) return;
  const std::span<const Dexel> left = rows_.after().column(i, j, left_);
  subtract(rows_.before().column(i, j, whole_), left, removed_);
  for (const Dexel& element : removed_) {
    if (!is_shallow(element, left)) measure(i, j, element);
  }
}

/// An element that ends at remaining stock ends on the surface of the sweep, so no point of it is
/// deeper than the element is long.
bool CutDepth::is_shallow(const Dexel& removed, std::span<const Dexel> left) const {
  const double long_mm = (removed.top - removed.bottom) * rows_.after().grid().z_quantum_mm;
  if (long_mm > sought_mm()) return false;
  return std::ranges::any_of(
      left, [&](const Dexel& d) { return d.top == removed.bottom || d.bottom == removed.top; });
}

/// The depth changes no faster than the height, so heights that cannot be as deep as sought are
/// skipped.
void CutDepth::measure(std::int32_t i, std::int32_t j, const Dexel& removed) {
  constexpr NearestPose kFar{0, std::numeric_limits<double>::infinity()};
  constexpr double kExact = -std::numeric_limits<double>::infinity();
  const DexelGrid& grid = rows_.after().grid();
  const double high = grid.z_mm(removed.top);
  for (double z = grid.z_mm(removed.bottom); z <= high;) {
    const Vec3 point{grid.x_mm(i), grid.y_mm(j), z};
    const double depth = -nearest_pose(motion_, point, kFar, kExact).mm;
    ++distances_;
    const double step = std::max(sought_mm() - depth, kSampleShare * grid.pitch_mm);
    depth_mm_ = std::max(depth_mm_, depth);
    // The end of the element is sampled as well.
    z = z < high ? std::min(z + step, high) : high + 1;
  }
}

}  // namespace kerf
