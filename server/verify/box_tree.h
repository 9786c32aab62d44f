// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf {

/// A box parallel to the axes.
struct Box {
  Vec3 low, high;
  /// Returns a lower bound of the signed distance of a point from anything inside the box: its
  /// distance from the box, or the negative of its depth in it.
  double distance_mm(Vec3 p) const {
    const Vec3 below = low - p, above = p - high;
    const double x = std::max(below.x, above.x), y = std::max(below.y, above.y),
                 z = std::max(below.z, above.z);
    const double deepest = std::max({x, y, z});
    if (deepest <= 0) return deepest;
    const Vec3 out{std::max(x, 0.0), std::max(y, 0.0), std::max(z, 0.0)};
    return length(out);
  }
};

/// Returns the smallest box around two boxes.
Box around(const Box& a, const Box& b);

/// A bounding-volume tree over boxes. Immutable and safe for concurrent use.
class BoxTree {
 public:
  BoxTree() = default;
  /// Keeps runs of `run` consecutive boxes together, which is faster if neighbors in the order are
  /// neighbors in space.
  explicit BoxTree(std::vector<Box> boxes, std::uint32_t run = 1);

  /// Calls visit(index) for the boxes whose Box::distance_mm is below `limit_mm`, nearer parts of
  /// the tree first. `limit_mm` is read again before each box, so the visitor can lower it to
  /// search for a least distance, or set it to -infinity to end.
  template <class Visit>
  void visit_nearest(Vec3 point, const double& limit_mm, Visit&& visit) const {
    if (!nodes_.empty()) descend(0, point, limit_mm, visit);
  }

 private:
  struct Node {
    Box box;
    std::uint32_t first,
        count;  ///< range of runs_; count 0: inner node, first is its right child
  };
  struct Run {
    Box box;
    std::uint32_t first, end;  ///< range of boxes_
  };
  void build(std::uint32_t first, std::uint32_t end);

  template <class Visit>
  void visit_run(const Run& run, Vec3 point, const double& limit_mm, Visit& visit) const {
    for (std::uint32_t i = run.first; i < run.end; ++i)
      if (boxes_[i].distance_mm(point) < limit_mm) visit(i);
  }
  template <class Visit>
  void descend(std::uint32_t n, Vec3 point, const double& limit_mm, Visit& visit) const {
    const Node& node = nodes_[n];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (runs_[i].box.distance_mm(point) < limit_mm) visit_run(runs_[i], point, limit_mm, visit);
    if (node.count > 0) return;
    std::pair<double, std::uint32_t> near{nodes_[n + 1].box.distance_mm(point), n + 1},
        far{nodes_[node.first].box.distance_mm(point), node.first};
    if (far.first < near.first) std::swap(near, far);
    for (const auto& [mm, child] : {near, far})
      if (mm < limit_mm) descend(child, point, limit_mm, visit);
  }

  std::vector<Node> nodes_;  ///< the left child of an inner node follows it
  std::vector<Run> runs_;
  std::vector<Box> boxes_;
};

}  // namespace kerf
