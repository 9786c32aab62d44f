// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kernel/sculpture_command.h"
#include "server/verify/air_space.h"

namespace kerf {

/// Joins consecutive air motions of a program into one straight motion at one speed.
class AirPath {
 public:
  /// Adds a motion if the straight motion to its end, at the same speed, passes within
  /// kAirToleranceMm of all poses so far. Returns false otherwise. An empty path accepts any
  /// motion.
  bool add(const MoveTool& move);
  /// The joined motion; nullopt if the path is empty.
  const std::optional<MoveTool>& joined() const { return joined_; }
  void clear();

 private:
  bool continues(const MoveTool& move) const;

  std::optional<MoveTool> joined_;
  double speed_mm_per_s_ = 0;       ///< of the first motion
  std::vector<Vec3> between_mm_{};  ///< tips where motions were joined
};

}  // namespace kerf
