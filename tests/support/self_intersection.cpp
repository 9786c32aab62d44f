// SPDX-License-Identifier: Apache-2.0
#include "tests/support/self_intersection.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "tests/support/exact_sign.h"

namespace kerf::test {
namespace {

struct Box {
  FloatPoint low, high;
};

Box box_of(const FloatTriangle& t) {
  Box box{t[0], t[0]};
  for (const FloatPoint& p : t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], p[axis]);
      box.high[axis] = std::max(box.high[axis], p[axis]);
    }
  }
  return box;
}

bool overlap(const Box& a, const Box& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (a.low[axis] > b.high[axis] || b.low[axis] > a.high[axis]) return false;
  }
  return true;
}

/// For each cell of a grid, the triangles whose boxes meet it.
class Buckets {
 public:
  explicit Buckets(double cell_mm) : cell_mm_(cell_mm) {}
  template <class Visit>
  void for_cells(const Box& box, Visit&& visit) {
    const auto cell = [this](float at) {
      return static_cast<std::int64_t>(std::floor(double(at) / cell_mm_));
    };
    for (std::int64_t x = cell(box.low[0]); x <= cell(box.high[0]); ++x) {
      for (std::int64_t y = cell(box.low[1]); y <= cell(box.high[1]); ++y) {
        for (std::int64_t z = cell(box.low[2]); z <= cell(box.high[2]); ++z) {
          visit(of_[static_cast<std::uint64_t>((x * 2097152 + y) * 2097152 + z)]);
        }
      }
    }
  }

 private:
  double cell_mm_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> of_;
};

}  // namespace

SelfIntersections count_self_intersections(const std::vector<TileMesh>& meshes, double cell_mm) {
  SelfIntersections found;
  std::vector<FloatTriangle> all;
  std::vector<Box> boxes;
  for (const TileMesh& mesh : meshes) {
    for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
      const FloatTriangle t{mesh.positions_mm[mesh.indices[n]],
                            mesh.positions_mm[mesh.indices[n + 1]],
                            mesh.positions_mm[mesh.indices[n + 2]]};
      ++found.triangles;
      if (are_collinear(t[0], t[1], t[2])) {
        ++found.zero_area;
        continue;
      }
      all.push_back(t);
      boxes.push_back(box_of(t));
    }
  }
  Buckets buckets(cell_mm);
  std::vector<bool> crossed(all.size());
  std::vector<std::uint32_t> near;
  for (std::uint32_t n = 0; n < all.size(); ++n) {
    near.clear();
    buckets.for_cells(boxes[n], [&](std::vector<std::uint32_t>& bucket) {
      for (const std::uint32_t other : bucket) {
        if (overlap(boxes[n], boxes[other])) near.push_back(other);
      }
      bucket.push_back(n);
    });
    std::ranges::sort(near);
    const auto tail = std::ranges::unique(near);
    near.erase(tail.begin(), tail.end());
    for (const std::uint32_t other : near) {
      if (!do_intersect(all[n], all[other])) continue;
      ++found.pairs;
      crossed[n] = crossed[other] = true;
    }
  }
  found.crossed = static_cast<std::size_t>(std::ranges::count(crossed, true));
  return found;
}

}  // namespace kerf::test
