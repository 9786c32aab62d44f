// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/formats/guide.h"

namespace kerf::agent {

/// A point of a path.
struct GuidePoint {
  Vec3 tip_mm{};
  Vec3 axis{0, 0, 1};
  Vec3 tangent{};  ///< unit; zero where the tip does not move
  /// Change of the axis with the tip's position along the tangent, 1/mm; zero at a pose.
  Vec3 axis_rate{};
  Wrench felt{};
  double distance_mm = 0;
};

/// Finds the point of polylines nearest to a given point, by a tree of bounding boxes over
/// consecutive segments. Queries do not allocate and examine a bounded number of boxes.
class PathTree {
 public:
  /// The constructor allocates. `paths` must contain at least one pose.
  explicit PathTree(const std::vector<GuidePath>& paths);

  /// Greatest number of boxes that a query examines. A path that is equally near everywhere, such
  /// as a circle around the point, would need all of them. The query then returns the nearest of
  /// the examined segments, which include those near the previous result.
  static constexpr std::size_t kMostVisits = 1024;

  /// Returns the point nearest to `tip_mm`. The next query begins at its segment.
  GuidePoint nearest(Vec3 tip_mm) noexcept;

  std::size_t segments() const noexcept { return segments_.size(); }
  /// Number of boxes that the last query examined.
  std::size_t visits() const noexcept { return visits_; }

 private:
  struct Segment {
    GuidePose from, to;
  };
  struct Box {
    Vec3 min_mm{}, max_mm{};
  };
  struct Best {
    std::size_t segment = 0;
    double share = 0, distance2 = 0;
  };

  Box build(std::size_t node, std::size_t first, std::size_t end);
  void examine(std::size_t segment, Vec3 tip_mm, Best& best) const noexcept;
  void search(Vec3 tip_mm, Best& best) noexcept;
  GuidePoint point(const Best& best) const noexcept;

  std::vector<Segment> segments_;
  std::vector<Box> boxes_;  ///< node n has the children 2n + 1 and 2n + 2
  std::size_t last_ = 0, visits_ = 0;
};

}  // namespace kerf::agent
