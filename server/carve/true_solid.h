// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <stop_token>
#include <vector>

#include "kernel/sculpture.h"
#include "server/carve/box_tree.h"
#include "server/carve/tool_profile.h"
#include "server/formats/program.h"

namespace kerf {

/// The exact solid that a program leaves: the stock less every pose of every motion, evaluated
/// point by point. It uses neither dexels nor sub-motions: the distance of a point from a tool is
/// exact, and its minimum along a motion is found to 1e-6 mm. It serves as an independent reference
/// for the kernel and is too slow for carving.
class TrueSolid {
 public:
  /// `reach_mm` limits the distances from cuts that are computed. `tools` must contain every tool
  /// of the program.
  TrueSolid(const StockShape& stock, const std::map<ToolId, SceneTool>& tools,
            const std::vector<ProgramMotion>& motions, double reach_mm);

  struct Distance {
    double mm;  ///< distance of the point from the boundary of the solid, >= 0
    bool cut;   ///< the nearest boundary was cut by a tool; false: it is the stock's own
  };
  /// Exact for points inside the solid. Outside, it is the length of a path along normals into the
  /// solid: equal to the distance except near an edge, where it may be longer. Ends early, with a
  /// result of no use, if a stop is requested.
  Distance distance(Vec3 point_mm, const std::stop_token& stop = {}) const;

 private:
  struct Sweep {
    const ToolProfile* tool;
    ToolPose from, to;
    double turn_rad, travel_mm;
  };
  struct Signed {
    double mm;
    Vec3 outward;
  };
  Signed from_stock(Vec3 point) const;
  Signed from_sweeps(Vec3 point, const std::stop_token& stop) const;

  StockShape stock_;
  std::map<ToolId, ToolProfile> profiles_;
  std::vector<Sweep> sweeps_;
  double reach_mm_;
  BoxTree tree_;  ///< of the sweeps
};

}  // namespace kerf
