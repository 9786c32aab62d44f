// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// Maximum deviation of a joined air motion from the original path.
inline constexpr double kAirToleranceMm = 0.001;

/// The region that air motions avoid: the box around the stock. A motion whose tool, shank and
/// holder stay outside removes nothing, whatever was cut before.
class AirSpace {
 public:
  explicit AirSpace(const SculptureSettings& settings);
  /// True if the motion cannot change the block and needs no force. Always false in a scene with
  /// obstacles and while the axis turns.
  bool contains(const MoveTool& move, const Tool& tool) const;
  /// True if the tool with shank and holder stays clear of the original stock. Always false while
  /// the axis turns.
  bool is_clear(const MoveTool& move, const Tool& tool) const;

 private:
  bool has_obstacles_;
  Vec3 low_mm_, high_mm_;
};

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
