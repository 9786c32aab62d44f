// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// Greatest distance by which a joined motion through the air may deviate from the original path.
inline constexpr double kAirToleranceMm = 0.001;

/// The region that motions through the air keep clear of: the box around the stock. A motion whose
/// tool, shank and holder stay outside removes nothing whatever has been cut before.
class AirSpace {
 public:
  explicit AirSpace(const SculptureSettings& settings);
  /// True if the motion cannot change the block and its force is not asked for. Always false in a
  /// scene with obstacles, and while the axis turns.
  bool contains(const MoveTool& move, const Tool& tool) const;
  /// True if the tool, with shank and holder, passes the stock whatever has been cut. Always false
  /// while the axis turns.
  bool is_clear(const MoveTool& move, const Tool& tool) const;

 private:
  bool has_obstacles_;
  Vec3 low_mm_, high_mm_;
};

/// Consecutive motions of a program through the air, joined into one straight motion at one speed.
class AirPath {
 public:
  /// Adds a motion if the straight motion to its end passes within kAirToleranceMm of all poses so
  /// far, at the same speed; false otherwise. An empty path takes any motion.
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
