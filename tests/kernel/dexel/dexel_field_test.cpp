// SPDX-License-Identifier: Apache-2.0
// Dexel fields: snapshots are immutable, hashes identify solids, and memory is proportional to the
// touched area, for blocks from 1 mm to 10 m and far from the origin.

#include "kernel/dexel/dexel_field.h"

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::dexel_field_test {
namespace {

const Vec3 kUp{0, 0, 1};

Sculpture block(const StockShape& stock, double pitch_mm, Rays rays = Rays::kDexel) {
  auto s = *Sculpture::create({.stock = stock, .rays = rays, .pitch_mm = pitch_mm});
  s.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  return s;
}

MotionResult cut(Sculpture& s, Vec3 from, Vec3 to) {
  return s.apply(MoveTool{1, {from, kUp}, {to, kUp}, 0.01, false}).value();
}

std::vector<Dexel> column(const DexelSnapshot& s, std::int32_t i, std::int32_t j) {
  std::vector<Dexel> scratch;
  const auto c = s.column(i, j, scratch);
  return {c.begin(), c.end()};
}

TEST(DexelSnapshot, IsImmutableWhileTheFieldChanges) {
  std::optional<DexelSnapshot> before, between;
  std::uint64_t hash_before = 0, hash_between = 0;
  double volume_between = 0;
  {
    auto s = block(BoxStock{{0, 0, 0}, {600, 600, 20}}, 0.5);
    before = s.snapshot();
    hash_before = before->hash();
    cut(s, {10, 10, 18}, {590, 590, 18});
    between = s.snapshot();
    hash_between = between->hash();
    volume_between = between->volume_mm3();
    cut(s, {10, 10, 15}, {590, 590, 15});
    cut(s, {10, 590, 15}, {590, 10, 15});
    EXPECT_NE(s.state_hash(), hash_between);
  }
  // The snapshots outlive the field.
  EXPECT_EQ(before->hash(), hash_before);
  EXPECT_FALSE(before->touched({3, 3}));
  EXPECT_EQ(between->hash(), hash_between);
  EXPECT_EQ(between->volume_mm3(), volume_between);
  EXPECT_NE(hash_before, hash_between);
}

/// Returns the first tile for editing, as a cut does.
DexelTile& edit(DexelField& field) {
  if (field.editable({0, 0}) == nullptr) field.put({0, 0}, field.fresh({0, 0}));
  return *field.editable({0, 0});
}

TEST(DexelSnapshot, HashIgnoresTouchedTilesThatEqualTheStock) {
  for (const StockShape& stock : {StockShape{BoxStock{{0, 0, 0}, {40, 40, 40}}},
                                  StockShape{CylinderStock{20, 20, 19, 0, 40}}}) {
    for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
      DexelField field(stock, 0.5, axis);
      const std::uint64_t untouched = field.snapshot().hash();
      const double volume = field.snapshot().volume_mm3();
      const DexelTile* tile = &edit(field);
      const DexelSnapshot touched = field.snapshot();
      EXPECT_TRUE(touched.touched({0, 0}));
      EXPECT_EQ(touched.hash(), untouched);
      EXPECT_EQ(touched.volume_mm3(), volume);
      EXPECT_EQ(volume, field.stock_volume_mm3());
      // Removing one quantum of one column changes the hash, and so does the choice of the column.
      DexelTile& own = edit(field);
      EXPECT_NE(&own, tile);
      const std::size_t inner = 31 * kTileSide + 31;
      ASSERT_LT(own.bottom[inner], own.top[inner]);
      --own.top[inner];
      const std::uint64_t other = field.snapshot().hash();
      EXPECT_NE(other, untouched);
      ++edit(field).top[inner];
      EXPECT_EQ(field.snapshot().hash(), untouched);
      ++edit(field).bottom[inner];
      EXPECT_NE(field.snapshot().hash(), untouched);
      EXPECT_NE(field.snapshot().hash(), other);
    }
  }
}

TEST(DexelSnapshot, HashDependsOnAxisAndStock) {
  const auto hash = [](const StockShape& stock, RayAxis axis) {
    return DexelField(stock, 0.5, axis).snapshot().hash();
  };
  const BoxStock cube{{0, 0, 0}, {10, 10, 10}};
  EXPECT_NE(hash(cube, RayAxis::kX), hash(cube, RayAxis::kY));
  EXPECT_NE(hash(cube, RayAxis::kX), hash(cube, RayAxis::kZ));
  EXPECT_NE(hash(cube, RayAxis::kZ), hash(BoxStock{{0, 0, 0}, {10, 10.5, 10}}, RayAxis::kZ));
  EXPECT_NE(hash(cube, RayAxis::kZ), hash(CylinderStock{5, 5, 5, 0, 10}, RayAxis::kZ));
  EXPECT_NE(hash(CylinderStock{5, 5, 5, 0, 10}, RayAxis::kZ),
            hash(CylinderStock{5, 5, 4.99, 0, 10}, RayAxis::kZ));
}

TEST(DexelSnapshot, VolumeIsTheSumOverColumns) {
  auto s = block(CylinderStock{0, 0, 25, 0, 30}, 0.5, Rays::kTriDexel);
  cut(s, {-20, 3, 12}, {20, 5, 22});
  cut(s, {-30, -8, 12}, {30, 9, 12});
  for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
    const DexelSnapshot snapshot = s.snapshot(axis);
    const DexelGrid& grid = snapshot.grid();
    std::int64_t quanta = 0;
    for (std::int32_t j = 0; j < grid.columns_y; ++j) {
      for (std::int32_t i = 0; i < grid.columns_x; ++i) {
        for (const Dexel& d : column(snapshot, i, j)) quanta += d.top - d.bottom;
      }
    }
    EXPECT_EQ(snapshot.volume_mm3(), double(quanta) * grid.quantum_mm3());
  }
}

TEST(Field, MemoryIsProportionalToTouchedArea) {
  // 10^10 columns, three times.
  auto s = block(BoxStock{{-5000, -5000, -5000}, {5000, 5000, 5000}}, 0.1, Rays::kTriDexel);
  const double stock = 1e12;
  EXPECT_NEAR(s.stock_volume_mm3() / stock, 1, 1e-12);
  EXPECT_LT(s.memory_bytes(), 32768u);
  const MotionResult r = cut(s, {1000, 2000, 4998}, {1050, 2000, 4998});
  EXPECT_FALSE(r.changed_tiles.empty());
  // A circular segment times the path, and a cap of the ball.
  const double exact = 50 * (25 * std::acos(0.6) - 12) + std::numbers::pi * 4 * 13 / 3;
  EXPECT_NEAR(r.removed_mm3, exact, 0.01 * exact);
  EXPECT_LT(s.memory_bytes(), 4u << 20);
  const DexelSnapshot snapshot = s.snapshot();
  EXPECT_NEAR(stock - snapshot.volume_mm3(), r.removed_mm3, 1);
  const std::uint64_t hash = s.state_hash();
  cut(s, {1000, 2000, 4998}, {1050, 2000, 4998});
  EXPECT_EQ(s.state_hash(), hash);
  cut(s, {4999, -4999, 4998}, {4999, -4998, 4998});
  EXPECT_NE(s.state_hash(), hash);
  EXPECT_EQ(s.snapshot(RayAxis::kX).grid().columns_x, 100000);
}

/// Returns the bytes per column of a block that is touched everywhere.
double bytes_of_a_column(bool keep_normals) {
  auto s = *Sculpture::create({.stock = BoxStock{{0, 0, 0}, {400, 400, 20}},
                               .pitch_mm = 0.2,
                               .keep_normals = keep_normals});
  EXPECT_TRUE(s.apply(DefineTool{1, *make_tool(BallShape{6, 40})}));
  const std::size_t before = s.memory_bytes();
  std::size_t tiles = 0;
  for (double y = 1; y < 400; y += 3) {
    EXPECT_TRUE(s.apply(MoveTool{1, {{0, y, 15}}, {{400, y, 15}}, 1, false}));
  }
  for (std::int32_t y = 0; y < s.grid().tiles_y(); ++y) {
    for (std::int32_t x = 0; x < s.grid().tiles_x(); ++x) {
      tiles += s.snapshot().touched({x, y}) ? 1 : 0;
    }
  }
  EXPECT_EQ(tiles, std::size_t{63} * 63);
  return double(s.memory_bytes() - before) / double(tiles * kTileColumns);
}

TEST(Field, TouchedColumnTakesLessThanTwiceItsElement) {
  EXPECT_LT(bytes_of_a_column(false), 2 * sizeof(Dexel));
}

TEST(Field, NormalsTakeNoMoreMemoryThanTheEnds) {
  const double without = bytes_of_a_column(false), with = bytes_of_a_column(true);
  EXPECT_GT(with, without);
  EXPECT_LT(with, without + 1.1 * sizeof(EndCodes));
}

TEST(Field, CarvingScalesByPowersOfTwoToTheBit) {
  // The same job scaled by powers of two gives the same columns to the bit.
  std::vector<std::vector<Dexel>> first;
  for (const double scale : {1.0, 16.0, 1.0 / 16}) {
    auto s = *Sculpture::create({.stock = BoxStock{{0, 0, 0}, {scale, scale, scale}},
                                 .rays = Rays::kTriDexel,
                                 .pitch_mm = scale / 64,
                                 .tolerance_mm = 1e-6});
    s.apply(DefineTool{1, *make_tool(FlatShape{0.25 * scale, 2 * scale})}).value();
    s.apply(MoveTool{1, {Vec3{.25, .3, .6} * scale, kUp}, {Vec3{.7, .6, .5} * scale, kUp}, 1})
        .value();
    std::vector<std::vector<Dexel>> columns;
    for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
      const DexelSnapshot snapshot = s.snapshot(axis);
      EXPECT_EQ(snapshot.grid().columns_x, 64);
      for (std::int32_t n = 0; n < 64 * 64; ++n) {
        columns.push_back(column(snapshot, n % 64, n / 64));
      }
    }
    if (first.empty()) first = columns;
    EXPECT_EQ(columns, first) << scale;
  }
}

TEST(Field, CarvingIsInvariantUnderTranslation) {
  const auto carve = [](Vec3 offset) {
    auto s = block(BoxStock{offset, offset + Vec3{30, 20, 15}}, 0.25, Rays::kTriDexel);
    cut(s, offset + Vec3{5, 5, 12}, offset + Vec3{25, 13, 9});
    return s;
  };
  auto here = carve({0, 0, 0});
  for (const Vec3 offset : {Vec3{1e4, -1e4, 1e4}, Vec3{-1e4, 1e4, -1e4}}) {
    auto there = carve(offset);
    for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
      const DexelSnapshot a = here.snapshot(axis), b = there.snapshot(axis);
      ASSERT_EQ(a.grid().columns_x, b.grid().columns_x);
      std::int32_t worst = 0;
      for (std::int32_t j = 0; j < a.grid().columns_y; ++j) {
        for (std::int32_t i = 0; i < a.grid().columns_x; ++i) {
          const std::vector<Dexel> p = column(a, i, j), q = column(b, i, j);
          ASSERT_EQ(p.size(), q.size()) << int(axis) << ' ' << i << ' ' << j;
          for (std::size_t k = 0; k < p.size(); ++k) {
            worst = std::max(
                {worst, std::abs(p[k].bottom - q[k].bottom), std::abs(p[k].top - q[k].top)});
          }
        }
      }
      // Coordinates of 10^4 mm are rounded to 2e-12 mm; a grazing ray amplifies that.
      EXPECT_LE(worst * a.grid().z_quantum_mm, 1e-6);
    }
  }
}

}  // namespace
}  // namespace kerf::dexel_field_test
