// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/cut.h"

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::cut_test {
namespace {

const Vec3 kUp{0, 0, 1};

Sculpture block(double pitch_mm = 0.5) {
  auto s = *Sculpture::create({.stock = BoxStock{{0, 0, 0}, {40, 40, 20}}, .pitch_mm = pitch_mm});
  s.apply(DefineTool{1, *make_tool(FlatShape{10, 5})}).value();
  s.apply(DefineTool{2, *make_tool(BallShape{6, 30})}).value();
  return s;
}

std::vector<Dexel> column_at(Sculpture& s, double x, double y) {
  const DexelSnapshot snapshot = s.snapshot();
  const DexelGrid& g = snapshot.grid();
  std::vector<Dexel> scratch;
  const auto dexels = snapshot.column(int((x - g.origin_mm.x) / g.pitch_mm),
                                      int((y - g.origin_mm.y) / g.pitch_mm), scratch);
  return {dexels.begin(), dexels.end()};
}

MoveTool stand(ToolId tool, Vec3 tip) { return {tool, {tip, kUp}, {tip, kUp}, 0}; }

TEST(Cut, ShortensTheTop) {
  Sculpture s = block();
  s.apply(stand(1, {20, 20, 17})).value();
  const auto c = column_at(s, 20.1, 20.1);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_DOUBLE_EQ(s.grid().z_mm(c[0].top), 17);
  EXPECT_EQ(c[0].bottom, 0);
}

TEST(Cut, RoundsThinCutsToTheNearestQuantum) {
  Sculpture s = block();
  const double quantum = s.grid().z_quantum_mm;
  const auto top_after = [&](double below_17_quanta) {
    const Vec3 tip{20, 20, 17 - below_17_quanta * quantum};
    s.apply(MoveTool{1, {tip, kUp}, {tip + Vec3{1, 0, 0}, kUp}, 0}).value();
    return s.grid().z_mm(column_at(s, 20.1, 20.1)[0].top);
  };
  EXPECT_DOUBLE_EQ(top_after(0), 17);
  EXPECT_DOUBLE_EQ(top_after(0.4), 17);
  EXPECT_DOUBLE_EQ(top_after(0.6), 17 - quantum);
  EXPECT_DOUBLE_EQ(top_after(1.4), 17 - quantum);
  EXPECT_DOUBLE_EQ(top_after(1.6), 17 - 2 * quantum);
}

TEST(Cut, ShortensTheBottom) {
  Sculpture s = block();
  s.apply(stand(1, {20, 20, -2})).value();
  const auto c = column_at(s, 20.1, 20.1);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_DOUBLE_EQ(s.grid().z_mm(c[0].bottom), 3);
  EXPECT_EQ(c[0].top, s.grid().height_quanta);
}

TEST(Cut, SplitsAColumnTwice) {
  Sculpture s = block();
  s.apply(stand(1, {20, 20, 12})).value();
  s.apply(stand(1, {20, 20, 3})).value();
  const auto c = column_at(s, 20.1, 20.1);
  ASSERT_EQ(c.size(), 3u);
  EXPECT_DOUBLE_EQ(s.grid().z_mm(c[0].top), 3);
  EXPECT_DOUBLE_EQ(s.grid().z_mm(c[1].bottom), 8);
  EXPECT_DOUBLE_EQ(s.grid().z_mm(c[1].top), 12);
  EXPECT_DOUBLE_EQ(s.grid().z_mm(c[2].bottom), 17);
  s.apply(stand(1, {20, 20, 7.5})).value();  // Removes the middle element and joins the two gaps.
  EXPECT_EQ(column_at(s, 20.1, 20.1).size(), 2u);
}

TEST(Cut, MatchesBruteForceSetOfDepths) {
  Sculpture s = block();
  const std::vector<double> lengths{0.1, 0.3, 1, 2.5};
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    s.apply(DefineTool{ToolId(10 + k), *make_tool(FlatShape{10, lengths[k]})}).value();
  }
  const DexelGrid& grid = s.grid();
  // One character per 0.05 mm of a column: solid or not.
  constexpr int kParts = 400;
  std::vector<bool> solid(kParts, true);
  std::mt19937 random(7);
  for (int n = 0; n < 250; ++n) {
    const std::size_t tool = random() % lengths.size();
    const int first = int(random() % (kParts + 20)) - 20;
    const int last = first + int(std::lround(lengths[tool] / 0.05));
    const MotionResult r = s.apply(stand(ToolId(10 + tool), {20, 20, first * 0.05})).value();
    int removed = 0;
    for (int part = std::max(first, 0); part < std::min(last, kParts); ++part) {
      removed += solid[std::size_t(part)] ? 1 : 0;
      solid[std::size_t(part)] = false;
    }
    // The disc of the tool has 316 columns at this pitch.
    ASSERT_NEAR(r.removed_mm3, 316 * 0.25 * 0.05 * removed, 1e-3) << n;
    std::vector<int> ends, expected;
    for (const Dexel& d : column_at(s, 20.1, 20.1)) {
      for (const std::int32_t end : {d.bottom, d.top}) {
        ends.push_back(int(std::lround(grid.z_mm(end) / 0.05)));
      }
    }
    for (int part = 0; part <= kParts; ++part) {
      const bool below = part > 0 && solid[std::size_t(part - 1)];
      const bool above = part < kParts && solid[std::size_t(part)];
      if (below != above) expected.push_back(part);
    }
    ASSERT_EQ(ends, expected) << n;
  }
}

TEST(Cut, RemovesAWholeColumn) {
  Sculpture s = block();
  for (const double z : {0.0, 5.0, 10.0, 15.0}) s.apply(stand(1, {20, 20, z})).value();
  EXPECT_TRUE(column_at(s, 20.1, 20.1).empty());
}

TEST(Cut, RepeatedPathChangesNothing) {
  Sculpture s = block();
  const MoveTool move{2, {{5, 5, 14}, kUp}, {{33, 30, 11}, normalized({0.2, 0.1, 1})}, 1};
  EXPECT_GT(s.apply(move).value().removed_mm3, 10);
  const std::uint64_t hash = s.state_hash();
  for (int i = 0; i < 100; ++i) {
    const MotionResult again = s.apply(move).value();
    ASSERT_EQ(again.removed_mm3, 0);
    ASSERT_TRUE(again.changed_tiles.empty());
  }
  EXPECT_EQ(s.state_hash(), hash);
}

std::vector<MoveTool> random_moves(unsigned seed, int count) {
  std::mt19937 random(seed);
  const test::Uniform in(random);
  std::vector<MoveTool> moves;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = normalized({in(-0.5, 0.5), in(-0.5, 0.5), 1});
    const Vec3 b = normalized({a.x + in(-0.1, 0.1), a.y + in(-0.1, 0.1), a.z});
    const Vec3 tip{in(0, 40), in(0, 40), in(2, 19)};
    moves.push_back(
        {ToolId(1 + i % 2), {tip, a}, {tip + Vec3{in(-5, 5), in(-5, 5), in(-2, 2)}, b}, 0.1});
  }
  return moves;
}

TEST(Cut, MotionsCommuteToTheBit) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    std::vector<MoveTool> moves = random_moves(seed, 40);
    Sculpture first = block();
    for (const MoveTool& m : moves) first.apply(m).value();
    std::mt19937 random(seed + 100);
    std::ranges::shuffle(moves, random);
    Sculpture second = block();
    for (const MoveTool& m : moves) second.apply(m).value();
    EXPECT_EQ(first.state_hash(), second.state_hash()) << "seed " << seed;
    EXPECT_NEAR(first.removed_volume_mm3(), second.removed_volume_mm3(), 1e-6);
  }
}

TEST(Cut, ClosedGapsDoNotDependOnTheStockTop) {
  // The groove of the tool is narrower than the tolerance, so it leaves no fin, even if the stock
  // has ended within it before.
  const double z = 12, groove = 0.0005, radius = 4, turn = 2e-5;
  const Tool grooved = *make_tool(ProfileShape{
      {ProfilePoint{radius, 0}, ProfilePoint{radius, 2}, ProfilePoint{1, 2},
       ProfilePoint{1, 2 + groove}, ProfilePoint{radius, 2 + groove}, ProfilePoint{radius, 20}}});
  const ToolPose from{{20, 20, z - 2}, kUp}, to{{20, 20, z - 2}, normalized(Vec3{turn, 0, 1})};
  for (const double share : {0.25, 0.5, 0.75, 1.5}) {
    const MoveTool level = stand(4, {20, 20, z + share * groove}), turning{3, from, to, 0};
    Sculpture first = block(), second = block();
    for (Sculpture* s : {&first, &second}) {
      s->apply(DefineTool{3, grooved}).value();
      s->apply(DefineTool{4, *make_tool(FlatShape{60, 8})}).value();
    }
    first.apply(level).value();
    first.apply(turning).value();
    second.apply(turning).value();
    second.apply(level).value();
    EXPECT_EQ(first.state_hash(), second.state_hash()) << share;
  }
}

TEST(Cut, VolumeDecreasesByTheRemovedVolume) {
  Sculpture s = block();
  double removed = 0;
  for (const MoveTool& m : random_moves(9, 60)) {
    const MotionResult r = s.apply(m).value();
    ASSERT_GE(r.removed_mm3, 0);
    removed += r.removed_mm3;
  }
  EXPECT_NEAR(s.snapshot().volume_mm3(), s.stock_volume_mm3() - removed, 1e-6);
}

TEST(Cut, SplittingATranslationChangesOnlyRounding) {
  Sculpture whole = block(), halves = block();
  const ToolPose a{{5, 8, 14}, normalized({0.3, -0.1, 1})}, b{{31, 27, 12}, a.axis};
  const ToolPose middle{(a.tip_mm + b.tip_mm) * 0.5, a.axis};
  whole.apply(MoveTool{2, a, b, 1}).value();
  halves.apply(MoveTool{2, a, middle, 1}).value();
  halves.apply(MoveTool{2, middle, b, 1}).value();
  const DexelSnapshot s = whole.snapshot(), t = halves.snapshot();
  std::vector<Dexel> c, d;
  for (int j = 0; j < s.grid().columns_y; ++j) {
    for (int i = 0; i < s.grid().columns_x; ++i) {
      const auto p = s.column(i, j, c), q = t.column(i, j, d);
      ASSERT_EQ(p.size(), q.size()) << i << ' ' << j;
      for (std::size_t k = 0; k < p.size(); ++k) {
        EXPECT_NEAR(s.grid().z_mm(p[k].top), s.grid().z_mm(q[k].top), 1e-6);
        EXPECT_NEAR(s.grid().z_mm(p[k].bottom), s.grid().z_mm(q[k].bottom), 1e-6);
      }
    }
  }
}

TEST(Cut, SnapshotOutlivesTheSculpture) {
  Sculpture s = block();
  s.apply(stand(1, {20, 20, 17})).value();
  const DexelSnapshot before = s.snapshot();
  const std::uint64_t hash = before.hash();
  s.apply(stand(1, {20, 20, 10})).value();
  s.apply(stand(1, {5, 5, 10})).value();
  EXPECT_EQ(before.hash(), hash);
  EXPECT_NE(s.state_hash(), hash);
}

TEST(Cut, StoresOnlyTheTilesItChanges) {
  Sculpture s = block();  // 80 x 80 columns: 3 x 3 tiles of 16 mm
  const MotionResult r = s.apply(stand(2, {8, 8, 15})).value();
  EXPECT_EQ(r.changed_tiles, (std::vector<TileIndex>{{0, 0}}));
  EXPECT_FALSE(s.snapshot().touched({1, 0}));
  EXPECT_TRUE(s.snapshot().touched({0, 0}));
  EXPECT_TRUE(s.apply(stand(2, {8, 8, 25})).value().changed_tiles.empty());
}

TEST(Cut, CylinderStockIsRound) {
  auto s = *Sculpture::create({.stock = CylinderStock{10, -5, 20, 0, 30}, .pitch_mm = 0.1});
  EXPECT_NEAR(s.stock_volume_mm3() / (M_PI * 400 * 30), 1, 1e-3);
  EXPECT_NEAR(s.snapshot().volume_mm3(), s.stock_volume_mm3(), 1e-6);
  s.apply(DefineTool{1, *make_tool(FlatShape{100, 50})}).value();
  const double removed = s.apply(stand(1, {10, -5, 25})).value().removed_mm3;
  EXPECT_NEAR(removed / (M_PI * 400 * 5), 1, 1e-3);
}

}  // namespace
}  // namespace kerf::cut_test
