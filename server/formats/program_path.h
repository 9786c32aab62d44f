// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/formats/program.h"

namespace kerf {

/// How the tip comes to a point of a path.
enum class PathKind : std::uint8_t {
  kStart,  ///< it is placed there: the line to the point before is not drawn
  kRapid,
  kFeed
};

struct PathPoint {
  Vec3 tip_mm;
  std::uint32_t line = 0;  ///< of the motion that ends here
  ToolId tool = 0;
  PathKind kind = PathKind::kStart;
  friend bool operator==(const PathPoint&, const PathPoint&) = default;
};

/// The path of the tip of a program, to be drawn.
struct ProgramPath {
  std::vector<PathPoint> points;
  double error_mm = 0;  ///< no point of the whole path is farther from the drawn one
};

/// Returns the path of a program with at most `points_max` points, at least 2: straight runs of one
/// tool and kind are joined within the smallest of a series of tolerances that suffices. A path
/// that has too many corners for that is thinned to every k-th motion; its error is then that of
/// the path's extents. Linear in the number of motions, for each tolerance that is tried.
ProgramPath drawn_path(const Program& program, std::size_t points_max);
/// The same of a path that has been thinned before; the errors add up.
ProgramPath drawn_path(const ProgramPath& path, std::size_t points_max);

}  // namespace kerf
