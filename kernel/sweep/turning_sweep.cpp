// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/turning_sweep.h"

#include <algorithm>
#include <cmath>

#include "kernel/sweep/turning_rows.h"

namespace kerf {
namespace {

/// Distance from the tip within which all of the slice lies.
double upper_reach(const Extent& e) {
  return std::sqrt(e.z1_mm * e.z1_mm + e.radius_mm * e.radius_mm);
}

SlicePath make_path(const Extent& e, const ToolPose& from, const ToolPose& to,
                    const SliceSearch& search) {
  const TurningFrame frame(from, to);
  const double reach = upper_reach(e);
  const double speed = length(frame.v) + frame.turn * reach;
  return {frame, search, speed > 0 ? speed : 1, 0};
}

std::vector<ToolPose> stations(const SlicePath& path, const ToolPose& from, const ToolPose& to) {
  const TurningFrame& f = path.frame;
  std::vector<ToolPose> poses{from};
  for (int i = 1; i < path.search.parts; ++i) {
    const TurningFrame::Poses at = f.at(Lanes(double(i) / path.search.parts));
    poses.push_back({f.tip + Vec3{at.tip.x[0], at.tip.y[0], at.tip.z[0]},
                     Vec3{at.u.x[0], at.u.y[0], at.u.z[0]}});
  }
  poses.push_back(to);
  return poses;
}

/// Returns the greatest distance of a point of the slice from the chord between two stations.
double bulge(const SlicePath& path, const Extent& e) {
  const double reach = upper_reach(e);
  const double turn = path.frame.turn / path.search.parts;
  return reach * turn * turn / 8 + kEdgeEpsilonMm;
}

std::variant<ConeSide, ArcSide> side_of(const ToolPiece& slice) {
  if (const auto* arc = std::get_if<ArcPiece>(&slice)) return ArcSide(*arc);
  return ConeSide(std::get<FrustumPiece>(slice));
}

}  // namespace

TurningSweep::TurningSweep(const ToolPiece& slice, const ToolPose& from, const ToolPose& to,
                           const SliceSearch& search)
    : side_(side_of(slice)),
      path_(make_path(extent(slice), from, to, search)),
      shadow_(slice, stations(path_, from, to), bulge(path_, extent(slice))) {
  path_.lowest_mm = shadow_.bounds().min_mm.z - path_.frame.tip.z;
}

void TurningSweep::evaluate(ColumnBlock& block) const {
  if (const auto* cone = std::get_if<ConeSide>(&side_)) {
    evaluate_cone(*cone, path_, block);
  } else {
    evaluate_arc(std::get<ArcSide>(side_), path_, block);
  }
}

}  // namespace kerf
