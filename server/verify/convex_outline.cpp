// SPDX-License-Identifier: Apache-2.0
#include "server/verify/convex_outline.h"

#include <algorithm>
#include <cstddef>

#include "server/formats/model/indexed_mesh.h"

namespace kerf {

/// Andrew's monotone chain: the lower border from left to right, then the upper one back.
ConvexOutline::ConvexOutline(const IndexedMesh& mesh) {
  std::vector<Point> points;
  points.reserve(mesh.positions_mm.size());
  for (std::uint32_t n = 0; n < mesh.positions_mm.size(); ++n) {
    const Vec3 at = mesh.origin_mm + mesh.position(n);
    points.push_back({at.x, at.y});
  }
  std::ranges::sort(points,
                    [](Point a, Point b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  const auto add = [this](Point point, std::size_t least) {
    while (corners_.size() >= least && turn(*(corners_.end() - 2), corners_.back(), point) <= 0) {
      corners_.pop_back();
    }
    corners_.push_back(point);
  };
  for (const Point& point : points) add(point, 2);
  const std::size_t upper = corners_.size() + 1;
  for (auto point = points.rbegin(); point != points.rend(); ++point) add(*point, upper);
  if (!corners_.empty()) corners_.pop_back();  // the first corner again
}

bool ConvexOutline::contains(double x_mm, double y_mm) const {
  const Point point{x_mm, y_mm};
  for (std::size_t n = 0; n < corners_.size(); ++n) {
    if (turn(corners_[n], corners_[(n + 1) % corners_.size()], point) < 0) return false;
  }
  return corners_.size() > 2;
}

}  // namespace kerf
