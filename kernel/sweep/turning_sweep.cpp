// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/turning_sweep.h"

#include <cmath>
#include <vector>

namespace kerf {
namespace {

std::vector<ToolPose> stations(const SlicePath& path, const ToolPose& from, const ToolPose& to) {
  const TurningFrame& f = path.frame;
  std::vector<ToolPose> poses{from};
  for (int i = 1; i < path.search.parts; ++i) {
    const TurningFrame::Poses at = f.placed(Lanes(double(i) / path.search.parts));
    poses.push_back(
        {Vec3{at.tip.x[0], at.tip.y[0], at.tip.z[0]}, Vec3{at.u.x[0], at.u.y[0], at.u.z[0]}});
  }
  poses.push_back(to);
  return poses;
}

/// Returns the greatest distance of a point of the slice from the chord between two stations.
double bulge(const SlicePath& path, const Extent& e) {
  const double reach = std::sqrt(e.z1_mm * e.z1_mm + e.radius_mm * e.radius_mm);
  const double turn = path.frame.turn / path.search.parts;
  return reach * turn * turn / 8 + kEdgeEpsilonMm;
}

}  // namespace

TurningSweep::TurningSweep(const ToolPiece& slice, const ToolPiece& whole, const ToolPose& from,
                           const ToolPose& to, ShownDiscs shown, const SliceSearch& search)
    : slice_(slice, whole, from, to, shown, search),
      shadow_(slice, stations(slice_.path(), from, to), bulge(slice_.path(), extent(slice))) {
  slice_.set_lowest(shadow_.bounds().min_mm.z);
}

}  // namespace kerf
