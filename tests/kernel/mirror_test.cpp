// SPDX-License-Identifier: Apache-2.0
// Motions and their mirror images leave columns that are equal to a quantum, where the mirror maps
// columns to columns: the page mirrors strokes by that (web/src/carve/mirror.ts). A column that the
// mirror turns upside down is equal to the tolerance, because upper and lower ends are computed
// differently.

#include <cmath>
#include <cstdlib>
#include <random>

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::mirror_test {
namespace {

constexpr Vec3 kSizeMm{14, 11, 9};

constexpr double Vec3::* kParts[] = {&Vec3::x, &Vec3::y, &Vec3::z};

ToolPose mirrored(ToolPose pose, int axis) {
  const auto part = kParts[axis];
  pose.tip_mm.*part = kSizeMm.*part - pose.tip_mm.*part;
  pose.axis.*part = -(pose.axis.*part);
  return pose;
}

/// Strokes of a page: tips on the grid of 1e-6 mm, axes of 32 bits.
class Strokes {
 public:
  explicit Strokes(unsigned seed) : random_(seed) {}

  std::vector<MoveTool> next(ToolId tool) {
    std::vector<MoveTool> stroke;
    ToolPose from = pose({7, 5.5, 4.5}, {});
    for (int n = 0; n < 6; ++n) {
      const ToolPose to = pose(from.tip_mm, from.axis);
      stroke.push_back({tool, from, to, 0.01, false});
      from = to;
    }
    return stroke;
  }

 private:
  double uniform(double reach) {
    return reach * (2.0 * static_cast<double>(random_()) / 4294967296.0 - 1);
  }
  ToolPose pose(Vec3 near, Vec3 axis) {
    const auto on_grid = [](double mm) { return std::round(mm * 1e6) / 1e6; };
    const Vec3 tip = near + Vec3{uniform(4), uniform(4), uniform(3)};
    const Vec3 turned = normalized(axis + Vec3{uniform(0.6), uniform(0.6), uniform(0.6)});
    const auto narrow = [](double value) { return static_cast<double>(static_cast<float>(value)); };
    return {{on_grid(tip.x), on_grid(tip.y), on_grid(tip.z)},
            {narrow(turned.x), narrow(turned.y), narrow(turned.z)}};
  }

  std::mt19937 random_;
};

/// Differences between the ends of columns and of their images.
struct Difference {
  std::int64_t ends = 0, above_quantum = 0;  ///< numbers of ends
  std::int64_t greatest = 0;                 ///< in quanta
  bool same_dexels = true;                   ///< every column has as many dexels as its image
};

Difference compare(const DexelSnapshot& block, RayAxis rays, int axis) {
  // The frames of the fields are (y, z, x) and (z, x, y).
  const int across = (axis - static_cast<int>(rays) + 2) % 3;  // 0: x, 1: y, 2: along the rays
  const DexelGrid& grid = block.grid();
  Difference sum;
  std::vector<Dexel> one_scratch, other_scratch;
  for (std::int32_t j = 0; j < grid.columns_y; ++j) {
    for (std::int32_t i = 0; i < grid.columns_x; ++i) {
      const std::int32_t u = across == 0 ? grid.columns_x - 1 - i : i;
      const std::int32_t v = across == 1 ? grid.columns_y - 1 - j : j;
      const auto one = block.column(i, j, one_scratch), other = block.column(u, v, other_scratch);
      sum.same_dexels = sum.same_dexels && one.size() == other.size();
      for (std::size_t n = 0; n < std::min(one.size(), other.size()); ++n) {
        Dexel image = across == 2 ? other[other.size() - 1 - n] : other[n];
        if (across == 2) {
          image = {grid.height_quanta - image.top, grid.height_quanta - image.bottom};
        }
        for (const std::int64_t ends :
             {std::int64_t{one[n].bottom} - image.bottom, std::int64_t{one[n].top} - image.top}) {
          ++sum.ends;
          sum.above_quantum += std::abs(ends) > 1 ? 1 : 0;
          sum.greatest = std::max(sum.greatest, std::abs(ends));
        }
      }
    }
  }
  return sum;
}

class Mirror : public testing::TestWithParam<int> {};

TEST_P(Mirror, ColumnsOfImagesAreEqualToAQuantum) {
  const int axis = GetParam();
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, 0}, kSizeMm};
  settings.rays = Rays::kTriDexel;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Sculpture block = Sculpture::create(settings).value();
    block.apply(DefineTool{1, *make_tool(BallShape{.diameter_mm = 3, .length_mm = 12})}).value();
    block.apply(DefineTool{2, *make_tool(FlatShape{.diameter_mm = 2, .length_mm = 12})}).value();
    block.apply(DefineTool{3, *make_tool(BullNoseShape{4, 1, 12})}).value();
    Strokes strokes(seed);
    for (ToolId tool = 1; tool <= 3; ++tool) {
      const std::vector<MoveTool> stroke = strokes.next(tool);
      for (const MoveTool& move : stroke) block.apply(move).value();
      for (MoveTool move : stroke) {
        move.from = mirrored(move.from, axis);
        move.to = mirrored(move.to, axis);
        block.apply(move).value();
      }
    }
    for (const RayAxis rays : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
      const DexelSnapshot fields = block.snapshot(rays);
      const Difference found = compare(fields, rays, axis);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", rays " +
                   std::to_string(static_cast<int>(rays)));
      EXPECT_TRUE(found.same_dexels);
      if (static_cast<int>(rays) == axis) {
        EXPECT_LE(static_cast<double>(found.greatest) * fields.grid().z_quantum_mm,
                  settings.tolerance_mm);
      } else {
        // Rounding errors are larger where a ray grazes the tool: a few ends in a hundred thousand.
        EXPECT_LE(found.above_quantum, found.ends / 5000);
        EXPECT_LE(found.greatest, 64);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Planes, Mirror, testing::Values(0, 1, 2));

}  // namespace
}  // namespace kerf::mirror_test
