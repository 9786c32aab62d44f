// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/formats/program.h"

namespace kerf {

/// Kind of motion to a point of a path.
enum class PathKind : std::uint8_t {
  kStart,  ///< placed there: no line from the previous point
  kRapid,
  kFeed
};

struct PathPoint {
  Vec3 tip_mm;
  std::uint32_t line = 0;  ///< line of the motion that ends here
  ToolId tool = 0;
  PathKind kind = PathKind::kStart;
  double time_s = 0;  ///< time of the tip here, at feed rate
  friend bool operator==(const PathPoint&, const PathPoint&) = default;
};

/// The path of a program's tip, for drawing.
struct ProgramPath {
  std::vector<PathPoint> points;
  double error_mm = 0;  ///< greatest distance of the whole path from the drawn one
};

/// Collects the path of a program, for drawing with at most `points_max` points, at least 2.
/// Straight runs of one tool and kind are joined within the smallest sufficient tolerance of a
/// series. A path with too many corners for that is thinned to every k-th motion. Its error is then
/// the size of the path's extents. Long paths are joined piece by piece with a growing tolerance,
/// so that at most about 2 kHeld points are in memory.
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
  std::vector<PathPoint> joined_, held_;  ///< within the tolerance; the last points, unchanged
  std::optional<BoxStock> extents_;
  double tolerance_mm_ = 0, error_mm_ = 0;
};

/// Returns the path of a program, as a PathCollector.
ProgramPath drawn_path(const Program& program, std::size_t points_max);
/// Like the above for a path that has been thinned before. The errors add up.
ProgramPath drawn_path(const ProgramPath& path, std::size_t points_max);

}  // namespace kerf
