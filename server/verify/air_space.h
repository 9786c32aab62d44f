// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sculpture_command.h"
#include "kernel/sculpture_settings.h"

namespace kerf {

/// Distance from the box of the stock within which no motion counts as clear of it, beyond a pitch.
/// Motions that are joined may deviate by it (AirPath).
inline constexpr double kAirToleranceMm = 0.001;

/// The region around the box of the stock. A motion whose tool, shank and
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

}  // namespace kerf
