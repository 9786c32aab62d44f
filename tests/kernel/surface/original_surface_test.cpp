// SPDX-License-Identifier: Apache-2.0
// Which parts of a tile's surface belong to the untouched stock.
#include "kernel/tool/tool_shape.h"
#include "tests/support/carvings.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::original_surface_test {
namespace {

constexpr double kPitchMm = 0.5;

double from_segment_mm(Vec3 p, Vec3 from, Vec3 to) {
  const Vec3 along = to - from;
  const double s = std::clamp(dot(p - from, along) / dot(along, along), 0.0, 1.0);
  return length(p - (from + along * s));
}

struct Counts {
  int original = 0, cut = 0, wrong = 0;
  int smeared = 0;  ///< triangles longer than a few pitches that are only in part original
};

class OriginalSurface : public testing::TestWithParam<Rays> {
 protected:
  static constexpr double kRadiusMm = 3;

  Sculpture create(SculptureSettings settings) {
    settings.pitch_mm = kPitchMm;
    settings.rays = GetParam();
    Sculpture block = std::move(Sculpture::create(settings).value());
    const BallShape ball{.diameter_mm = 2 * kRadiusMm, .length_mm = 60};
    EXPECT_TRUE(block.apply(DefineTool{1, make_tool(ball).value()}));
    const FlatShape flat{.diameter_mm = 2 * kRadiusMm, .length_mm = 60};
    EXPECT_TRUE(block.apply(DefineTool{2, make_tool(flat).value()}));
    return block;
  }
  Sculpture create_of(const StockShape& stock) {
    SculptureSettings settings{.stock = stock};
    return create(settings);
  }
  /// Cuts a slot with the ball, whose center moves between two points.
  void cut(Sculpture& block, Vec3 from, Vec3 to) {
    const Vec3 up{0, 0, 1};
    EXPECT_TRUE(
        block.apply(MoveTool{1, {from - up * kRadiusMm, up}, {to - up * kRadiusMm, up}, 1, false}));
    slots_.push_back([=](Vec3 p) {
      if (p.z > from.z) p.z = from.z;
      return from_segment_mm(p, from, to) - kRadiusMm;
    });
  }
  /// Cuts a channel with a flat floor along x, through the whole block.
  void cut_channel(Sculpture& block, double y_mm, double z_mm) {
    const Vec3 up{0, 0, 1};
    EXPECT_TRUE(
        block.apply(MoveTool{2, {{-99, y_mm, z_mm}, up}, {{99, y_mm, z_mm}, up}, 1, false}));
    slots_.push_back(
        [=](Vec3 p) { return std::max(std::abs(p.y - y_mm) - kRadiusMm, z_mm - p.z); });
  }
  /// Compares the vertices with the shapes of stock and slots. `inside_mm` returns the distance of
  /// a point from the surface of the stock, inwards. Vertices within a pitch and a half of the
  /// border between both surfaces are not judged.
  template <class Inside>
  Counts judge(Sculpture& block, const Inside& inside_mm) const {
    Counts counts;
    const SolidSnapshot solid = block.solid();
    for (const TileMesh& mesh : test::mesh_all(solid)) {
      EXPECT_EQ(mesh.original.size(), mesh.positions_mm.size());
      for (std::size_t v = 0; v < mesh.original.size(); ++v) {
        const auto& p = mesh.positions_mm[v];
        const Vec3 at = solid.grid().origin_mm + Vec3{double(p[0]), double(p[1]), double(p[2])};
        double off_slots_mm = 1e9;
        for (const auto& off_mm : slots_) off_slots_mm = std::min(off_slots_mm, off_mm(at));
        const bool is_cut = inside_mm(at) > 1.5 * kPitchMm,
                   is_outer = off_slots_mm > 1.5 * kPitchMm;
        EXPECT_FALSE(is_cut && is_outer);
        ++(mesh.original[v] != 0 ? counts.original : counts.cut);
        counts.wrong += (is_cut && mesh.original[v] != 0) || (is_outer && mesh.original[v] == 0);
      }
      for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
        counts.smeared += is_smeared(mesh, t);
    }
    return counts;
  }

  static bool is_smeared(const TileMesh& mesh, std::size_t triangle) {
    bool is_long = false, is_mixed = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = mesh.indices[triangle + c], b = mesh.indices[triangle + (c + 1) % 3];
      const auto &p = mesh.positions_mm[a], &q = mesh.positions_mm[b];
      is_long |= double(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2])) > 4 * kPitchMm;
      is_mixed |= mesh.original[a] != mesh.original[b];
    }
    return is_long && is_mixed;
  }

  std::vector<std::function<double(Vec3)>> slots_;  ///< distances from the cuts, outwards
};

double inside_box(Vec3 p, Vec3 low, Vec3 high) {
  return std::min(
      {p.x - low.x, high.x - p.x, p.y - low.y, high.y - p.y, p.z - low.z, high.z - p.z});
}

TEST_P(OriginalSurface, BoxIsDistinctFromCuts) {
  const Vec3 low{0, 0, 0}, high{30, 20, 12};
  Sculpture block = create_of(BoxStock{low, high});
  const auto inside = [&](Vec3 p) { return inside_box(p, low, high); };
  EXPECT_EQ(judge(block, inside).cut, 0);
  cut(block, {8, 10, 11}, {40, 12, 11});  // a slot that is open at a side
  cut(block, {6, 5, 7}, {15, 5, 7});      // and one deep inside
  const Counts counts = judge(block, inside);
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_EQ(counts.smeared, 0);
  EXPECT_GT(counts.cut, 500);
  EXPECT_GT(counts.original, 100);
}

TEST_P(OriginalSurface, EndsAtTheRimOfAFlatChannel) {
  const Vec3 low{0, 0, 0}, high{30, 20, 12};
  Sculpture block = create_of(BoxStock{low, high});
  cut_channel(block, 10, 8);
  const Counts counts = judge(block, [&](Vec3 p) { return inside_box(p, low, high); });
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_EQ(counts.smeared, 0);
  EXPECT_GT(counts.cut, 4);
}

TEST_P(OriginalSurface, CylinderIsDistinctFromCuts) {
  Sculpture block = create_of(CylinderStock{10, 10, 10, 0, 12});
  const auto inside = [](Vec3 p) {
    return std::min({10 - std::hypot(p.x - 10, p.y - 10), p.z, 12 - p.z});
  };
  EXPECT_EQ(judge(block, inside).cut, 0);
  cut(block, {10, 10, 11}, {25, 10, 11});
  const Counts counts = judge(block, inside);
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_EQ(counts.smeared, 0);
  EXPECT_GT(counts.cut, 200);
  EXPECT_GT(counts.original, 200);
}

/// |x| + |y| + |z| <= 12, with a box-shaped cavity around the middle.
SculptureSettings octahedron_with_a_cavity() {
  TriangleMesh mesh;
  for (const double r : {12.0, -12.0}) {
    for (const Vec3 v : {Vec3{r, 0, 0}, Vec3{0, r, 0}, Vec3{0, 0, r}})
      mesh.vertices_mm.push_back(v);
  }
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                    {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (int n = 0; n < 8; ++n) {
    mesh.vertices_mm.push_back({n & 1 ? 2.0 : -2.0, n & 2 ? 2.0 : -2.0, n & 4 ? 2.0 : -2.0});
  }
  for (const auto& [a, b, c, d] : {std::array{0U, 1U, 3U, 2U},
                                   {4U, 6U, 7U, 5U},
                                   {0U, 4U, 5U, 1U},
                                   {2U, 3U, 7U, 6U},
                                   {0U, 2U, 6U, 4U},
                                   {1U, 5U, 7U, 3U}}) {
    mesh.triangles.push_back({6 + a, 6 + b, 6 + c});
    mesh.triangles.push_back({6 + a, 6 + c, 6 + d});
  }
  return SculptureSettings{.stock_mesh = std::make_shared<const TriangleMesh>(std::move(mesh))};
}

TEST_P(OriginalSurface, MeshWithACavityIsDistinctFromCuts) {
  const auto inside = [](Vec3 p) {
    const double outer = (12 - std::abs(p.x) - std::abs(p.y) - std::abs(p.z)) / std::sqrt(3);
    const double cavity = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 2;
    return std::min(outer, std::abs(cavity));
  };
  Sculpture block = create(octahedron_with_a_cavity());
  const Counts whole = judge(block, inside);
  EXPECT_EQ(whole.cut, 0);
  EXPECT_GT(whole.original, 500);
  cut(block, {-20, 6, 2}, {20, 6, 2});
  const Counts counts = judge(block, inside);
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_GT(counts.cut, 100);
  // A restarted server restores the tiles of a snapshot.
  Sculpture again = create(octahedron_with_a_cavity());
  ASSERT_TRUE(again.restore(block.solid()));
  const Counts restored = judge(again, inside);
  EXPECT_EQ(restored.cut, counts.cut);
  EXPECT_EQ(restored.original, counts.original);
}

INSTANTIATE_TEST_SUITE_P(Rays, OriginalSurface, testing::Values(Rays::kDexel, Rays::kTriDexel));

}  // namespace
}  // namespace kerf::original_surface_test
