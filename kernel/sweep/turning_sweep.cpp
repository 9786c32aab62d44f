// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/turning_sweep.h"

#include <algorithm>
#include <cmath>

#include "kernel/sweep/turning_rows.h"

namespace kerf {
namespace {

/// Distance from the tip within which all of the envelope lies.
double upper_reach(const FrustumPiece& e) {
  const double radius = extent(e).radius_mm;
  return std::sqrt(e.z1_mm * e.z1_mm + radius * radius);
}

SlicePath make_path(const FrustumPiece& e, const ToolPose& from, const ToolPose& to,
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

/// Returns the greatest distance of a point of the envelope from the chord between two stations.
double bulge(const SlicePath& path, const FrustumPiece& e) {
  const double reach = upper_reach(e);
  const double turn = path.frame.turn / path.search.parts;
  return reach * turn * turn / 8 + kEdgeEpsilonMm;
}

}  // namespace

TurningSweep::TurningSweep(const std::variant<ConeSide, ArcSide>& side,
                           const FrustumPiece& envelope, const ToolPose& from, const ToolPose& to,
                           const SliceSearch& search)
    : side_(side),
      path_(make_path(envelope, from, to, search)),
      shadow_(envelope, stations(path_, from, to), bulge(path_, envelope)) {
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
