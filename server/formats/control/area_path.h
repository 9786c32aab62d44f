// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <string>
#include <vector>

namespace kerf {

/// A straight move or an arc of the tool's center in a plane, mm.
struct AreaMove {
  double x = 0, y = 0;  ///< its end
  int turns = 0;        ///< 1: arc, counterclockwise; -1: clockwise; 0: straight
  double center_x = 0, center_y = 0;
};
/// Most moves of a cycle.
inline constexpr std::size_t kAreaMovesMax = 100'000;
/// A path. Its first move only states where the path begins.
using AreaPath = std::vector<AreaMove>;
/// A path, or the reason why the tool cannot follow it.
using AreaResult = std::expected<AreaPath, std::string>;

/// A rectangle about the origin with rounded corners; a circle if `corner` is half of both sides.
struct RoundedRectangle {
  double length = 0, width = 0;  ///< along x and y, mm
  double corner = 0;             ///< radius, mm
};

/// Clears a pocket from its middle outward, in loops at most `step` apart. Corners get the radius
/// of the tool if that is larger. `step` is reduced if necessary, so that no material remains.
AreaResult clear_pocket(const RoundedRectangle& pocket, double tool_radius, double step);
/// Mills a stud out of a blank, from outside inward. Begins outside the blank.
AreaResult mill_stud(const RoundedRectangle& stud, const RoundedRectangle& blank,
                     double tool_radius, double step);
/// Clears a slot along an arc about the origin, with round ends about the ends of the arc.
struct ArcSlot {
  double radius = 0, width = 0, first_deg = 0, sweep_deg = 0;
};
AreaResult clear_arc_slot(const ArcSlot& slot, double tool_radius, double step);
/// Faces a rectangle with a corner at the origin in strokes along x or y, back and forth, that
/// begin and end at its edges. `length` and `width` may be negative.
AreaResult face(double length, double width, bool along_x, double tool_radius, double step);
/// Returns the last loop of a pocket, a slot or a stud.
AreaPath last_loop(const AreaPath& path);

/// Turns a path about the origin, then moves it.
AreaPath placed(AreaPath path, double x, double y, double turn_deg);

/// Depths of passes from `top` (exclusive) down to `bottom`, each at most `infeed` > 0 below the
/// last; one pass if `infeed` is 0. Heights in mm.
std::vector<double> pass_levels(double top, double bottom, double infeed);

}  // namespace kerf
