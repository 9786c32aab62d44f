// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "kernel/sculpture.h"
#include "server/carve/tool_profile.h"
#include "server/formats/program.h"

namespace kerf {

/// What a program truly leaves of a stock: the stock less every pose of every motion (design
/// section 3), asked point by point. It uses no dexel and no sub-motion: the distance of a point
/// from a tool is exact, and its least value along a motion is searched for to 1e-6 mm. That makes
/// it a judge of what the kernel carves; far too slow to carve with.
class TrueSolid {
 public:
  /// `reach_mm`: distances from cuts are of interest up to here. Tools that the program uses must
  /// be among `tools`.
  TrueSolid(const StockShape& stock, const std::map<ToolId, SceneTool>& tools,
            const std::vector<ProgramMotion>& motions, double reach_mm);

  struct Distance {
    double mm;  ///< of the point from the border of the solid, >= 0
    bool cut;   ///< the nearest border was made by a tool; false: it is the stock's own
  };
  /// Exact for points inside the solid. Outside of it, the length of a way along normals into it:
  /// equal to the distance but at an edge of the solid, where it may be longer.
  Distance distance(Vec3 point_mm) const;

 private:
  struct Sweep {
    const ToolProfile* tool;
    ToolPose from, to;
    double turn_rad, travel_mm;
    Vec3 low, high;  ///< bounds of all poses
  };
  struct Signed {
    double mm;
    Vec3 outward;
  };
  struct Cell {
    std::uint32_t begin, end;
  };
  Signed from_stock(Vec3 point) const;
  Signed from_sweeps(Vec3 point) const;
  void fill_cells(double reach_mm);
  Cell cell_of(Vec3 point) const;

  StockShape stock_;
  std::map<ToolId, ToolProfile> profiles_;
  std::vector<Sweep> sweeps_;
  double reach_mm_;
  Vec3 origin_;
  double cell_mm_ = 1;
  std::int32_t cells_x_ = 1, cells_y_ = 1;
  std::vector<Cell> cells_;          ///< row-major
  std::vector<std::uint32_t> near_;  ///< sweeps of each cell
};

}  // namespace kerf
