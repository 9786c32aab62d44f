// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "server/verify/air_space.h"
#include "server/verify/convex_outline.h"

namespace kerf {

/// The result of a motion of a program.
struct ProgramCut {
  MotionResult result;
  double depth_mm = 0;  ///< how deep a rapid has cut (CutDepth); 0 for other motions
};

/// Cuts the motions of a program, as many together as keep several threads busy. A rapid near the
/// stock is cut alone, because its depth is measured in the stock before and after it.
class ProgramCutter {
 public:
  /// The references must outlive this. `feel`: forces are computed. `within`: if not null, rapids
  /// are measured in that outline only.
  ProgramCutter(const Scene& scene, const Program& program, Sculpture& sculpture, Workers& workers,
                bool feel, const ConvexOutline* within = nullptr);

  /// Cuts the first of these motions of the program, at least one of them. The error of a motion
  /// that the block rejects begins with its place; the block is then incomplete. A requested stop
  /// ends the measurement of a depth early.
  std::expected<std::vector<ProgramCut>, std::string> cut(std::span<const ProgramMotion> motions,
                                                          const std::stop_token& stop);

 private:
  MoveTool move_of(const ProgramMotion& motion) const;
  bool is_rapid_near_stock(const ProgramMotion& motion) const;
  ProgramCut cut_alone(const ProgramMotion& motion, const std::stop_token& stop);
  std::expected<void, std::string> check(const ProgramMotion& motion) const;
  double depth_of(const ProgramMotion& motion, const DexelSnapshot& before,
                  const MotionResult& result, const std::stop_token& stop);

  const Scene& scene_;
  const Program& program_;
  Sculpture& sculpture_;
  Workers& workers_;
  bool feel_;
  const ConvexOutline* within_;
  AirSpace air_;
};

}  // namespace kerf
