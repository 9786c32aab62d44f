// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/program.h"
#include "server/verify/box_tree.h"
#include "server/verify/moving_tool.h"
#include "server/verify/stock_mesh.h"

namespace kerf {

/// Limits the effort of queries. Once it is spent, results are not valid.
struct QueryEffort {
  std::size_t left;  ///< motions whose distance may still be computed
  bool spent() const { return left == 0; }
};

/// The exact solid that a program leaves: the stock less every pose of every motion, evaluated
/// point by point. It uses neither dexels nor sub-motions: the distance of a point from a tool is
/// exact, and its minimum along a motion is found to 1e-6 mm. It serves as an independent reference
/// for the kernel and is too slow for carving.
class TrueSolid {
 public:
  /// `reach_mm` limits the computed distances from cuts. `tools` must contain every tool of the
  /// program. `mesh`, if not null, is the stock. `stock` is then its bounding box.
  TrueSolid(const StockShape& stock, const std::map<ToolId, SceneTool>& tools,
            const std::vector<ProgramMotion>& motions, double reach_mm,
            const TriangleMesh* mesh = nullptr);
  TrueSolid(const TrueSolid&) = delete;
  TrueSolid& operator=(const TrueSolid&) = delete;

  struct Distance {
    double mm;  ///< distance of the point from the boundary of the solid, >= 0
    bool cut;   ///< the nearest boundary was cut by a tool; false: it is the stock's own
  };
  /// Exact for points inside the solid. Outside, it is the length of a path along normals into the
  /// solid: equal to the distance except near an edge, where it may be longer. Ends early, with an
  /// invalid result, if a stop is requested.
  Distance distance(Vec3 point_mm, const std::stop_token& stop = {}) const;

  /// A signed distance and the direction in which it grows.
  struct Signed {
    double mm;
    Vec3 outward;
  };
  /// Returns the signed distance from the stock, negative inside. From a mesh, at most `limit_mm`
  /// (StockMesh::nearest).
  Signed from_stock(Vec3 point_mm, double limit_mm = std::numeric_limits<double>::infinity()) const;
  /// Returns whether a point is in the stock and in no cut.
  bool is_solid(Vec3 point_mm, QueryEffort* effort = nullptr) const;
  /// Returns the signed distance from the nearest cut, at most `reach_mm`. Negative inside a cut:
  /// the greatest depth in a single one.
  Signed from_cuts(Vec3 point_mm, const std::stop_token& stop = {},
                   QueryEffort* effort = nullptr) const;
  /// Returns whether no cut is nearer to the point than `radius_mm` (0: whether the point is in no
  /// cut). Much faster than from_cuts().
  bool is_clear(Vec3 point_mm, double radius_mm, QueryEffort* effort = nullptr) const;

  /// Returns the motions, in the order of the program.
  std::span<const MovingTool> sweeps() const { return sweeps_; }
  /// Returns the motion that cuts deepest at a point, or comes nearest to it within the reach;
  /// sweeps().size() without one.
  std::size_t nearest_sweep(Vec3 point_mm) const;
  /// Returns the stock, or the box around its mesh.
  const StockShape& stock() const { return stock_; }
  /// Returns the mesh of the stock, or null.
  const StockMesh* mesh() const { return mesh_.get(); }

 private:
  struct Nearest {
    std::size_t sweep;
    NearestPose pose;
  };
  Nearest nearest(Vec3 point, double limit_mm, double enough_mm, const std::stop_token& stop,
                  QueryEffort* effort) const;

  StockShape stock_;
  std::unique_ptr<StockMesh> mesh_;
  std::map<ToolId, ToolProfile> profiles_;
  std::vector<MovingTool> sweeps_;
  double reach_mm_;
  BoxTree tree_;  ///< of the sweeps
};

}  // namespace kerf
