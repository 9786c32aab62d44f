// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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
  double time_s = 0;  ///< at which the tip is there, at feed rate
  friend bool operator==(const PathPoint&, const PathPoint&) = default;
};

/// The path of the tip of a program, to be drawn.
struct ProgramPath {
  std::vector<PathPoint> points;
  double error_mm = 0;  ///< no point of the whole path is farther from the drawn one
};

/// Collects the path of a program, to be drawn with at most `points_max` points, at least 2:
/// straight runs of one tool and kind are joined within the smallest of a series of tolerances that
/// suffices. A path that has too many corners for that is thinned to every k-th motion; its error
/// is then that of the path's extents. Long paths are joined piece by piece with a growing
/// tolerance, so that at most about 2 kHeld points are in memory.
class PathCollector {
 public:
  /// Paths with fewer points have the smallest error.
  static constexpr std::size_t kHeld = 160'000;

  explicit PathCollector(std::size_t points_max) : points_max_(points_max) {}
  /// Adds the next motion of the program.
  void add(const ProgramMotion& motion);
  ProgramPath take();

 private:
  void add(const PathPoint& point);
  void join_held();

  std::size_t points_max_;
  std::optional<ToolPose> at_;
  double time_s_ = 0;
  std::vector<PathPoint> joined_, held_;  ///< within the tolerance; the last points as they are
  std::optional<BoxStock> extents_;
  double tolerance_mm_ = 0, error_mm_ = 0;
};

/// Returns the path of a program, as a PathCollector.
ProgramPath drawn_path(const Program& program, std::size_t points_max);
/// The same of a path that has been thinned before; the errors add up.
ProgramPath drawn_path(const ProgramPath& path, std::size_t points_max);

}  // namespace kerf
