// SPDX-License-Identifier: Apache-2.0
// Columns of many elements against a brute-force model: a motion removes from a column the interval
// that it removes from that column of the whole block, minus the parts that are already gone.
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::split_columns_test {
namespace {

constexpr double kSideMm = 12, kHeightMm = 20;

using Elements = std::vector<Dexel>;

/// All columns of a block, from the bottom up in each.
std::vector<Elements> columns_of(Sculpture& sculpture) {
  const DexelSnapshot snapshot = sculpture.snapshot();
  const DexelGrid& grid = snapshot.grid();
  std::vector<Elements> columns;
  std::vector<Dexel> scratch;
  for (std::int32_t j = 0; j < grid.columns_y; ++j) {
    for (std::int32_t i = 0; i < grid.columns_x; ++i) {
      const auto dexels = snapshot.column(i, j, scratch);
      columns.emplace_back(dexels.begin(), dexels.end());
    }
  }
  return columns;
}

/// Returns the intersection of two solids.
Elements common(const Elements& a, const Elements& b) {
  Elements both;
  for (const Dexel& one : a) {
    for (const Dexel& other : b) {
      const Dexel part{std::max(one.bottom, other.bottom), std::min(one.top, other.top)};
      if (part.bottom < part.top) both.push_back(part);
    }
  }
  return both;
}

std::int64_t quanta(const std::vector<Elements>& columns) {
  std::int64_t sum = 0;
  for (const Elements& column : columns) {
    for (const Dexel& d : column) sum += d.top - d.bottom;
  }
  return sum;
}

Sculpture block(std::span<const Tool> tools) {
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, 0}, {kSideMm, kSideMm, kHeightMm}};
  settings.pitch_mm = 0.75;
  Sculpture sculpture = Sculpture::create(settings).value();
  for (std::size_t n = 0; n < tools.size(); ++n) {
    EXPECT_TRUE(sculpture.apply(DefineTool{ToolId(n + 1), tools[n]}));
  }
  return sculpture;
}

/// Discs and balls that are thin enough to divide columns. Half of the motions are level, within
/// three quanta of whole tenths of a millimetre, so that their ends meet those of earlier ones or
/// miss them by very little.
MoveTool random_motion(std::mt19937& random, std::size_t tools, double quantum_mm) {
  std::uniform_real_distribution<double> place(-2, kSideMm + 2), part(0, 1), turn(-0.4, 0.4);
  const ToolId tool = ToolId(1 + random() % tools);
  const double tenths = kHeightMm * 10;
  if (random() % 2 == 0) {
    const double z = std::floor(part(random) * tenths) / 10 + (int(random() % 7) - 3) * quantum_mm;
    const Vec3 from{place(random), place(random), z};
    const Vec3 to = random() % 2 == 0 ? from : Vec3{place(random), place(random), z};
    return {tool, {from, {0, 0, 1}}, {to, {0, 0, 1}}, 0};
  }
  const auto pose = [&] {
    const Vec3 tip{place(random), place(random), part(random) * kHeightMm};
    return ToolPose{tip, normalized(Vec3{turn(random), turn(random), 1})};
  };
  ToolPose from = pose(), to = pose();
  if (random() % 2 == 0) to.axis = from.axis;
  return {tool, from, to, 0};
}

TEST(SplitColumns, LoseTheIntervalsOfWholeColumns) {
  const std::vector<Tool> tools{*make_tool(FlatShape{4, 0.1}), *make_tool(FlatShape{6, 0.3}),
                                *make_tool(BallShape{0.8, 0.9}), *make_tool(FlatShape{3, 1})};
  std::size_t most = 0;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    Sculpture carved = block(tools);
    std::vector<Elements> model = columns_of(carved);
    for (int n = 0; n < 150; ++n) {
      const MoveTool motion = random_motion(random, tools.size(), carved.grid().z_quantum_mm);
      Sculpture whole = block(tools);
      ASSERT_TRUE(whole.apply(motion));
      const std::vector<Elements> rest = columns_of(whole);
      const std::int64_t before = quanta(model);
      for (std::size_t c = 0; c < model.size(); ++c) model[c] = common(model[c], rest[c]);
      const MotionResult result = carved.apply(motion).value();
      const std::vector<Elements> now = columns_of(carved);
      for (std::size_t c = 0; c < model.size(); ++c) {
        ASSERT_EQ(now[c], model[c]) << "seed " << seed << ", motion " << n << ", column " << c;
        most = std::max(most, now[c].size());
      }
      const DexelGrid& grid = carved.grid();
      const double quantum_mm3 = grid.pitch_mm * grid.pitch_mm * grid.z_quantum_mm;
      ASSERT_NEAR(result.removed_mm3, double(before - quanta(model)) * quantum_mm3, 1e-6);
    }
  }
  EXPECT_GT(most, 12u) << "columns were not divided often enough to be a test";
}

}  // namespace
}  // namespace kerf::split_columns_test
