// SPDX-License-Identifier: Apache-2.0
#include "server/verify/gouge_check.h"

#include "server/carve/misfits.h"
#include "tests/support/carvings.h"
#include "tests/support/test.h"

namespace kerf::gouge_check_test {
namespace {

constexpr double kPitchMm = 0.5, kToleranceMm = 0.1;
const BoxStock kStock{{0, 0, 0}, {40, 20, 10}};

/// A block under a ball, and a part: the block less a slanting groove.
class GougeCheckTest : public testing::Test {
 protected:
  GougeCheckTest() {
    Sculpture part = make_block();
    cut(part, {5, 10, 6}, {35, 10, 7}, 3);
    SnapshotMesh surface(part.solid());
    mesh_ = collect_mesh(surface);
    distance_.emplace(mesh_);
    reference_.name = "part.stl";
    reference_.part = std::make_shared<const PartModel>(mesh_, *distance_, block_.grid());
    reference_.tolerance_mm = kToleranceMm;
  }
  static Sculpture make_block() {
    Sculpture block = test::make_sculpture(kStock, kPitchMm);
    for (const double diameter_mm : {3.0, 4.0}) {
      const Tool ball = make_tool(BallShape{.diameter_mm = diameter_mm, .length_mm = 30}).value();
      EXPECT_TRUE(block.apply(DefineTool{static_cast<ToolId>(diameter_mm), ball}));
    }
    return block;
  }
  static std::vector<FieldTile> cut(Sculpture& block, Vec3 from, Vec3 to, ToolId tool) {
    const Vec3 up{0, 0, 1};
    return block.apply(MoveTool{tool, {from, up}, {to, up}, 1, false}).value().cut_tiles;
  }

  Sculpture block_ = make_block();
  IndexedMesh mesh_;
  std::optional<MeshDistance> distance_;
  GougeReference reference_;
};

TEST_F(GougeCheckTest, ExactPartHasNoGouges) {
  const auto before = block_.snapshot();
  const auto tiles = cut(block_, {5, 10, 6}, {35, 10, 7}, 3);
  GougeCheck check(reference_, before, block_.snapshot(), tiles);
  EXPECT_TRUE(check.advance(1'000'000));
  EXPECT_FALSE(check.deepest());
}

TEST_F(GougeCheckTest, DeepestGougeIsInTheDeepGroove) {
  const auto before = block_.snapshot();
  const auto tiles = cut(block_, {5, 10, 5.5}, {35, 10, 6.5}, 3);
  GougeCheck check(reference_, before, block_.snapshot(), tiles);
  EXPECT_TRUE(check.advance(1'000'000));
  ASSERT_TRUE(check.deepest());
  EXPECT_NEAR(check.deepest()->depth_mm, 0.5, 0.02);  // the mesh of the groove has this accuracy
  EXPECT_NEAR(check.deepest()->at_mm.y, 10, kPitchMm);
}

/// An earlier gouge does not count for the next motion.
TEST_F(GougeCheckTest, EarlierCutsDoNotCount) {
  cut(block_, {5, 10, 5.5}, {35, 10, 6.5}, 3);
  const auto before = block_.snapshot();
  const auto tiles = cut(block_, {5, 10, 6}, {35, 10, 7}, 3);
  GougeCheck check(reference_, before, block_.snapshot(), tiles);
  EXPECT_TRUE(check.advance(1'000'000));
  EXPECT_FALSE(check.deepest());
}

/// The second cut leaves the tops of its columns unchanged.
TEST_F(GougeCheckTest, FindsGougesBelowAnOverhang) {
  const auto cut_from_the_side = [&](double z) {
    const Vec3 side{1, 0, 0};
    const MoveTool move{3, {{20, 5, z}, side}, {{20, 15, z}, side}, 1, false};
    return block_.apply(move).value().cut_tiles;
  };
  cut_from_the_side(7);
  const auto before = block_.snapshot();
  const auto tiles = cut_from_the_side(3);
  const auto after = block_.snapshot();
  GougeCheck check(reference_, before, after, tiles);
  EXPECT_TRUE(check.advance(10'000'000));
  const Misfits all = find_gouges(before, after, *reference_.part, kToleranceMm);
  ASSERT_GT(all.count, 0);
  ASSERT_TRUE(check.deepest());
  EXPECT_EQ(check.deepest()->depth_mm, all.worst.front().depth_mm);
}

TEST_F(GougeCheckTest, PortionsFindTheSameGougesAsAFullSearch) {
  std::mt19937 random(7);
  const test::Uniform value(random);
  int gouged = 0;
  for (int n = 0; n < 120; ++n) {
    const auto before = block_.snapshot();
    const Vec3 from{value(0, 40), value(0, 20), value(5, 10)};
    const Vec3 to = from + Vec3{value(-6, 6), value(-6, 6), value(-2, 2)};
    const auto tiles = cut(block_, from, to, n % 2 == 0 ? 3 : 4);
    const auto after = block_.snapshot();
    const Misfits all = find_gouges(before, after, *reference_.part, kToleranceMm);
    GougeCheck check(reference_, before, after, tiles);
    while (!check.advance(3)) {
    }
    ASSERT_EQ(check.deepest().has_value(), all.count > 0) << "motion " << n;
    if (all.count == 0) continue;
    ++gouged;
    EXPECT_EQ(check.deepest()->depth_mm, all.worst.front().depth_mm) << "motion " << n;
  }
  EXPECT_GT(gouged, 20);
  EXPECT_LT(gouged, 120);
}

}  // namespace
}  // namespace kerf::gouge_check_test
