#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/sweep/column_row.h"

namespace kerf {

/// The shadow of a swept piece on the XY plane, enclosed by the hull of up to four equal circles:
/// tells for each row which columns can be hit, so that a slanting sweep does not pay for its
/// bounding box.
class Outline {
 public:
  /// `centers` are the circles' centres (z ignored), `radius_mm` their common radius.
  Outline(std::array<Vec3, 4> centers, double radius_mm) : centers_(centers), radius_(radius_mm) {}

  /// Columns of the row at y that the hull can cover.
  XRange row(double y) const {
    XRange range{1e300, -1e300};
    for (std::size_t i = 0; i < 4; ++i) {
      add_circle(range, centers_[i], y);
      for (std::size_t j = i + 1; j < 4; ++j) add_side(range, centers_[i], centers_[j], y);
    }
    return range;
  }

 private:
  void add_circle(XRange& range, Vec3 c, double y) const {
    const double h2 = radius_ * radius_ - (y - c.y) * (y - c.y);
    if (h2 < 0) return;
    const double h = std::sqrt(h2);
    range.lo_mm = std::min(range.lo_mm, c.x - h);
    range.hi_mm = std::max(range.hi_mm, c.x + h);
  }
  /// Where the row crosses the two lines that touch both circles.
  void add_side(XRange& range, Vec3 a, Vec3 b, double y) const {
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double n = std::sqrt(dx * dx + dy * dy);
    if (n == 0) return;
    for (const double side : {radius_ / n, -radius_ / n}) {
      const double px = a.x - dy * side, py = a.y + dx * side;
      const double share = (y - py) / dy;
      if (!(share >= 0 && share <= 1)) continue;
      const double x = px + share * dx;
      range.lo_mm = std::min(range.lo_mm, x);
      range.hi_mm = std::max(range.hi_mm, x);
    }
  }

  std::array<Vec3, 4> centers_;
  double radius_;
};

}  // namespace kerf
