// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptic_agent/demo/height_map.h"
#include "kernel/math/vec3.h"

namespace kerf::demo {

/// A ball-end tool of the scene demo.json.
struct BallTool {
  std::uint32_t id;
  double radius_mm;
  double length_mm;
};

/// A tool pose.
struct DemoPose {
  Vec3 tip_mm;
  Vec3 axis;  ///< unit, from the tip to the spindle
};

/// One stroke: the tool is lowered to the first pose, cuts up to the last one, and is retracted.
struct Stroke {
  std::uint32_t tool;
  double feed_mm_per_s;
  std::vector<DemoPose> poses;
};

/// Settings of a tool that follows the surface.
struct FollowSettings {
  double allowance_mm = 0;   ///< material left on the target surface
  double tilt_max_deg = 38;  ///< from +Z
  double tilt_share = 1;     ///< fraction of the angle between +Z and the surface normal
  double step_mm = 0.7;      ///< distance between poses
  double smooth_mm = 3;      ///< length over which the axis is averaged
};

/// Makes a ball-end tool follow a target surface along lines in the XY plane, as close as possible
/// without cutting below it: the ball touches the surface, and the axis tilts with the surface
/// normal as far as the shank stays clear.
class Follower {
 public:
  Follower(const HeightMap& target, BallTool tool, FollowSettings settings);
  /// Returns the stroke along `line`, which has at least two points. Their z is ignored. The tip
  /// stays above `level_mm`.
  Stroke along(const std::vector<Vec3>& line, double feed_mm_per_s, double level_mm = -1e9) const;

 private:
  Vec3 center(Vec3 at, double level_mm) const;
  Vec3 preferred_axis(Vec3 center_mm) const;
  Vec3 clear_axis(Vec3 center_mm, Vec3 axis) const;
  bool is_clear(Vec3 center_mm, Vec3 axis) const;

  BallTool tool_;
  FollowSettings settings_;
  HeightMap centers_;
};

/// Divides strokes into strokes of at most `seconds` at their feeds. Neighbors share a pose.
std::vector<Stroke> divided(const std::vector<Stroke>& strokes, double seconds);

/// Rest above the block before each stroke. An agent whose force was switched off, for example
/// because the machine stalled, arms again meanwhile.
inline constexpr double kRestSeconds = 0.5;
/// Returns the strokes as an APT program, with rapid moves at `retract_mm` between them.
std::string apt_text(const std::string& name, const std::vector<Stroke>& strokes,
                     double retract_mm);

/// Returns the duration of the strokes at their feeds, without the rapid moves, s.
double cutting_seconds(const std::vector<Stroke>& strokes);

}  // namespace kerf::demo
