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

/// Where the tip is and which way the spindle points.
struct DemoPose {
  Vec3 tip_mm;
  Vec3 axis;  ///< unit
};

/// One stroke: the tool comes down on the first pose, stays in the material to the last, and
/// leaves.
struct Stroke {
  std::uint32_t tool;
  double feed_mm_per_s;
  std::vector<DemoPose> poses;
};

/// How a tool follows the surface.
struct Following {
  double leave_mm = 0;       ///< stays on the wanted surface
  double tilt_max_deg = 38;  ///< from +Z
  double tilt_share = 1;     ///< of the angle between +Z and the surface's normal
  double step_mm = 0.7;      ///< between poses
  double smooth_mm = 3;      ///< the axis is averaged over so much way
};

/// Lets a ball-end tool follow a wanted surface along lines drawn on the XY plane, as near as it
/// can without cutting below it: its ball rests on the surface, its axis leans with the surface's
/// normal as far as its shank stays clear.
class Follower {
 public:
  Follower(const HeightMap& wanted, BallTool tool, Following following);
  /// `line` has at least two points; its z does not matter. The tip stays above `level_mm`.
  Stroke along(const std::vector<Vec3>& line, double feed_mm_per_s, double level_mm = -1e9) const;

 private:
  Vec3 center(Vec3 at, double level_mm) const;
  Vec3 wished_axis(Vec3 center_mm) const;
  Vec3 clear_axis(Vec3 center_mm, Vec3 axis) const;
  bool is_clear(Vec3 center_mm, Vec3 axis) const;

  BallTool tool_;
  Following following_;
  HeightMap centers_;
};

/// The strokes as an APT program: rapid moves high above the block between them.
std::string apt_text(const std::string& name, const std::vector<Stroke>& strokes,
                     double retract_mm);

/// How long the program takes at its feeds, without the rapid moves, s.
double cutting_seconds(const std::vector<Stroke>& strokes);

}  // namespace kerf::demo
