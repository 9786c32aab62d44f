// SPDX-License-Identifier: Apache-2.0
// Volumes of blocks that the pitch does not divide, against closed forms.

#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/mesh_stock.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/motion_in_pieces.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::volume_test {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double low, double high) {
    return low + (high - low) * (double(engine_()) / 4294967296.0);
  }

 private:
  std::mt19937 engine_;
};

SculptureSettings settings_of(StockShape stock, double pitch_mm, Rays rays) {
  return SculptureSettings{.stock = stock,
                           .rays = rays,
                           .pitch_mm = pitch_mm,
                           .tolerance_mm = 1e-3 * pitch_mm,
                           .keep_normals = false};
}

/// Defines a flat mill as tool 1 that covers the block.
void define_cover(Sculpture& block) {
  const BoxStock box = stock_bounds(block.settings().stock);
  const double size = length(box.max_mm - box.min_mm);
  block.apply(DefineTool{1, *make_tool(FlatShape{3 * size, 3 * size})}).value();
}

/// Moves the cover down along the middle of the block.
MoveTool lowered(const Sculpture& block, double from_mm, double to_mm) {
  const BoxStock box = stock_bounds(block.settings().stock);
  const Vec3 middle = (box.min_mm + box.max_mm) * 0.5;
  return {1, {{middle.x, middle.y, from_mm}}, {{middle.x, middle.y, to_mm}}, 1, false};
}

BoxStock random_box(Random& random, double pitch_mm) {
  const auto place = [&] { return random.in(-50, 50) * pitch_mm; };
  const auto side = [&] { return random.in(0.3, 18) * pitch_mm; };
  const double x = place(), y = place(), z = place();
  const double across = side(), along = side(), up = side();
  return {{x, y, z}, {x + across, y + along, z + up}};
}

double volume(const BoxStock& box) {
  const Vec3 size = box.max_mm - box.min_mm;
  return size.x * size.y * size.z;
}

TEST(Volume, RandomBoxesAndTheirCutsAreExact) {
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    Random random(seed);
    const double pitch = std::pow(10, random.in(-2, 1));
    const BoxStock box = random_box(random, pitch);
    const Rays rays = seed % 2 == 0 ? Rays::kDexel : Rays::kTriDexel;
    SCOPED_TRACE(seed);
    Sculpture block = *Sculpture::create(settings_of(box, pitch, rays));
    const double all = volume(box), exact = 1e-9 * all;
    ASSERT_NEAR(block.stock_volume_mm3(), all, exact);

    // Down to a height between two rows of rays, at which all fields agree.
    define_cover(block);
    const Vec3 size = box.max_mm - box.min_mm;
    const auto rows = static_cast<int>(std::max(1.0, std::floor(size.z / pitch + 0.5)));
    const int left = rows - 1 - static_cast<int>(random.in(0, 1) * (rows - 1));
    const double height = box.min_mm.z + left * pitch;
    const double above = size.x * size.y * (box.max_mm.z - height);
    const MotionResult first = block.apply(lowered(block, box.max_mm.z, height)).value();
    EXPECT_NEAR(first.removed_mm3, above, 1e-3 * above);
    EXPECT_NEAR(block.snapshot(RayAxis::kZ).volume_mm3(), all - above, 1e-6 * all);

    const MotionResult rest = block.apply(lowered(block, height, box.min_mm.z - pitch)).value();
    EXPECT_NEAR(block.removed_volume_mm3(), all, 1e-6 * all);
    EXPECT_NEAR(block.snapshot(RayAxis::kZ).volume_mm3(), 0, exact);

    // All stock is restored.
    std::vector<TileReplacement> whole;
    for (const MotionResult& result : {first, rest}) {
      for (const FieldTile& tile : result.cut_tiles) whole.push_back({tile, nullptr});
    }
    EXPECT_NEAR(block.replace(whole, {}).returned_mm3, all, 1e-6 * all);
  }
}

TEST(Volume, MotionInPiecesAndItsImprintAreExact) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const BoxStock box{{0, 0, 0}, {1.4, 3.3, 2.6}};
    const SculptureSettings settings = settings_of(box, 1, rays);
    Sculpture block = *Sculpture::create(settings), in_pieces = *Sculpture::create(settings);
    define_cover(block);
    define_cover(in_pieces);
    const MoveTool move = lowered(block, 2, -1);
    const MotionResult whole = block.apply(move).value();
    MotionInPieces pieces = in_pieces.begin(move).value();
    std::optional<MotionResult> result;
    while (!result) result = in_pieces.advance(pieces, 1);
    // The cover begins at a height of 2, so everything above is its imprint.
    EXPECT_NEAR(whole.removed_mm3, 1.4 * 3.3 * 2.6, 1e-6);
    EXPECT_NEAR(whole.imprint_mm3, 1.4 * 3.3 * 0.6, 1e-6);
    EXPECT_DOUBLE_EQ(result->removed_mm3, whole.removed_mm3);
    EXPECT_DOUBLE_EQ(result->imprint_mm3, whole.imprint_mm3);
  }
}

/// Returns the thrust of a plunge into the middle of a block; the tool's axis is off the middle.
double thrust_n(const BoxStock& box, double pitch_mm, Rays rays, ForceLaw law) {
  SculptureSettings settings = settings_of(box, pitch_mm, rays);
  settings.force.law = law;
  settings.force.specific_force_n_per_mm2 = 7;
  settings.force.drr_n_s_per_mm3 = 7;
  settings.force.milling.feed_per_tooth_mm = 0.1;
  settings.force.milling.cut_n_per_mm2 = {600, 300, 200};
  Sculpture block = *Sculpture::create(settings);
  block.apply(DefineTool{1, *make_tool(FlatShape{60, 40})}).value();
  Wrench wrench;
  for (int n = 0; n < 4; ++n) {
    const Vec3 from{20, 1, box.max_mm.z - 0.5 * n}, to = from - Vec3{0, 0, 0.5};
    wrench = block.apply(MoveTool{1, {from}, {to}, 0.5, true}).value().wrench;
  }
  return wrench.force_n.z;
}

TEST(Volume, ForcesUseTheExactVolume) {
  const BoxStock box{{0, 0, 0}, {3.3, 3.3, 6}};
  for (const ForceLaw law : {ForceLaw::kSpecificEnergy, ForceLaw::kDexelRemovalRate}) {
    // One field samples a plunge exactly; rays across it meet its floor row by row.
    EXPECT_NEAR(thrust_n(box, 0.5, Rays::kDexel, law), 7 * 3.3 * 3.3, 1e-3);
    EXPECT_NEAR(thrust_n(box, 0.5, Rays::kTriDexel, law), 7 * 3.3 * 3.3, 0.01 * 7 * 3.3 * 3.3);
  }
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const double divided = thrust_n(box, 0.55, rays, ForceLaw::kMechanistic);
    EXPECT_GT(divided, 0);
    EXPECT_NEAR(thrust_n(box, 0.5, rays, ForceLaw::kMechanistic), divided, 0.01 * divided);
  }
}

TEST(Volume, BlockThatThePitchDividesEqualsItsColumns) {
  const BoxStock box{{-50.3, 0.1, -7}, {-40.3, 12.4, 5.3}};
  for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
    const DexelField field(box, 0.1, axis);
    const DexelGrid& grid = field.grid();
    const double quanta =
        double(grid.columns_x) * double(grid.columns_y) * double(grid.height_quanta);
    EXPECT_EQ(field.stock_volume_mm3(), quanta * grid.quantum_mm3());
    for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
      for (std::int32_t x = 0; x < grid.tiles_x(); ++x)
        EXPECT_TRUE(field.shares().are_whole({x, y}));
    }
    EXPECT_EQ(field.shares().of(grid.columns_x - 1, grid.columns_y - 1), 1);
  }
}

TEST(Volume, CylindersAreAccurate) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const double pitch = random.in(0.05, 0.5), radius = 0.5 * pitch * random.in(199.5, 200.5);
    const double height = pitch * random.in(3, 12), x = random.in(-9, 9);
    const CylinderStock cylinder{x, random.in(-9, 9), radius, 0, height};
    const double all = std::numbers::pi * radius * radius * height;
    const Rays rays = seed % 3 > 0 ? Rays::kDexel : Rays::kTriDexel;
    Sculpture block = *Sculpture::create(settings_of(cylinder, pitch, rays));
    EXPECT_NEAR(block.stock_volume_mm3(), all, 1e-3 * all) << seed;
    define_cover(block);
    const MotionResult result = block.apply(lowered(block, height, -pitch)).value();
    EXPECT_NEAR(result.removed_mm3, all, 1e-3 * all) << seed;
    EXPECT_NEAR(block.snapshot(RayAxis::kZ).volume_mm3(), 0, 1e-9 * all) << seed;
  }
}

/// Returns an upright prism over a polygon, counter-clockwise, convex.
TriangleMesh prism(const std::vector<Vec3>& polygon, double height_mm) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(polygon.size());
  for (const Vec3& p : polygon) mesh.vertices_mm.push_back(p);
  for (const Vec3& p : polygon) mesh.vertices_mm.push_back(p + Vec3{0, 0, height_mm});
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    mesh.triangles.push_back({k, next, n + next});
    mesh.triangles.push_back({k, n + next, n + k});
    if (k < 2) continue;
    mesh.triangles.push_back({0, k, k - 1});
    mesh.triangles.push_back({n, n + k - 1, n + k});
  }
  return mesh;
}

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices_mm[t[0]], &b = mesh.vertices_mm[t[1]],
               &c = mesh.vertices_mm[t[2]];
    sum += dot(a, cross(b, c)) / 6;
  }
  return sum;
}

/// Returns a regular polygon, stretched along x and turned.
std::vector<Vec3> polygon(int corners, double radius_mm, double stretch, double turn_rad) {
  std::vector<Vec3> all;
  for (int k = 0; k < corners; ++k) {
    const double a = 2 * std::numbers::pi * (k + 0.5) / corners;
    const double x = stretch * radius_mm * std::cos(a), y = radius_mm * std::sin(a);
    const double c = std::cos(turn_rad), s = std::sin(turn_rad);
    all.push_back({3 + x * c - y * s, x * s + y * c - 5, 0.7});
  }
  return all;
}

TEST(Volume, MeshesAreAccurate) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const int corners = seed % 4 == 3 ? 60 : static_cast<int>(3 + seed % 4);
    // Turned arbitrarily, by almost nothing, and by 45 degrees.
    const double turn = seed % 3 == 0   ? random.in(0, 7)
                        : seed % 3 == 1 ? random.in(-0.02, 0.02)
                                        : std::numbers::pi / 4;
    auto mesh = std::make_shared<TriangleMesh>(
        prism(polygon(corners, 10, random.in(0.6, 1), turn), random.in(1, 3)));
    // Every second prism leans.
    const Vec3 lean{random.in(-0.5, 0.5), random.in(-0.5, 0.5), random.in(-0.5, 0.5)};
    for (Vec3& v : mesh->vertices_mm) {
      if (seed % 2 == 0) v = v + cross(lean, v);
    }
    const double all = volume(*mesh);
    const BoxStock box = mesh_bounds(*mesh);
    const Vec3 size = box.max_mm - box.min_mm;
    const double pitch = std::max({size.x, size.y, size.z}) / random.in(199.5, 200.5);
    SculptureSettings settings =
        settings_of(box, pitch, seed % 5 > 0 ? Rays::kDexel : Rays::kTriDexel);
    settings.stock_mesh = mesh;
    Sculpture block = *Sculpture::create(settings);
    EXPECT_NEAR(block.stock_volume_mm3(), all, 1e-3 * all) << seed;
    define_cover(block);
    const MotionResult result =
        block.apply(lowered(block, box.max_mm.z + pitch, box.min_mm.z - pitch)).value();
    EXPECT_NEAR(result.removed_mm3, all, 1e-3 * all) << seed;
    EXPECT_NEAR(block.snapshot(RayAxis::kZ).volume_mm3(), 0, 1e-6 * all) << seed;
  }
}

TEST(Volume, BoxMeshEqualsTheBox) {
  for (const double pitch : {0.25, 0.1, 1.0}) {
    const double side = pitch == 0.1 ? 10 : 10.12;
    auto mesh = std::make_shared<TriangleMesh>(
        prism({{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}}, side));
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SculptureSettings settings = settings_of(BoxStock{}, pitch, rays);
      settings.stock_mesh = mesh;
      EXPECT_NEAR(Sculpture::create(settings)->stock_volume_mm3(), side * side * side, 1e-6);
    }
  }
}

}  // namespace
}  // namespace kerf::volume_test
