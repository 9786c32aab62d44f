// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernel/math/vec3.h"
#include "kernel/math/wrench.h"

namespace kerf {

// Guides of a scene: virtual fixtures that haptic devices render. They never change the cut.
// Distances are those of the tool's tip.

/// A pose on the path of a guide. Between two of them the tip moves on a straight line.
struct GuidePose {
  Vec3 tip_mm{};
  Vec3 axis{0, 0, 1};  ///< unit
  Wrench felt{};       ///< of a stroke: the wrench that its teacher felt there, about the pivot
};
/// Poses in order; at least one.
using GuidePath = std::vector<GuidePose>;

/// Keeps the tool near a path: the tip within a distance of it, the axis within an angle of the
/// path's axis there.
struct PathGuide {
  double within_mm = 3;
  double axis_within_deg = 180;
  double turn_stiffness_nmm_per_rad = 1000;
  double max_torque_nmm = 60;
  /// A teacher's stroke: the teacher's wrench, times felt_share, is added along the path.
  bool stroke = false;
  double felt_share = 1;
  std::string file;  ///< file that the paths were read from; "" if the scene lists them
  std::vector<GuidePath> paths;
};
/// Keeps the tip on the side of a plane that its normal points to.
struct PlaneGuide {
  Vec3 point_mm{};
  Vec3 normal{0, 0, 1};  ///< unit
};
/// Keeps the tip at or above a height.
struct DepthGuide {
  double lowest_z_mm = 0;
};
/// Keeps the tip out of a box. Pushes it out of the nearest face.
struct RegionGuide {
  Vec3 min_mm{}, max_mm{};
};
/// The surface of a box, or of the upright cylinder inscribed in it.
struct SnapSurface {
  bool cylinder = false;
  Vec3 min_mm{}, max_mm{};
};
/// Draws the tip to a surface from up to `range_mm` on either side.
struct SnapGuide {
  double range_mm = 5;
  std::optional<SnapSurface> surface;  ///< of a scene: always set; by default the uncut stock's
};

/// A guide of a scene.
struct Guide {
  std::variant<PathGuide, PlaneGuide, DepthGuide, RegionGuide, SnapGuide> shape;
  double stiffness_n_per_mm = 1;
  double max_force_n = 3;
};

/// Returns the name of a guide's kind in scenes: "path", "stroke", "plane", "depth", "region" or
/// "snap".
const char* kind_of(const Guide& guide);

/// Greatest component of a pose's felt wrench, N and N·mm, and greatest felt_share.
inline constexpr double kGuideFeltMax = 1e6;
inline constexpr double kGuideFeltShareMax = 10;
/// Allowed length of a given axis or normal.
inline constexpr double kGuideAxisMin = 1e-6;
inline constexpr double kGuideAxisMax = 1e6;

/// Most guides of a scene, and most poses of all its paths together.
inline constexpr std::size_t kGuidesMax = 16;
inline constexpr std::size_t kGuidePosesMax = 20'000;

}  // namespace kerf
