// SPDX-License-Identifier: Apache-2.0
// Motions that are applied together give the same bytes as one after the other, regardless of the
// threads that do parts of them, and of their order.

#include <malloc.h>

#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/sculpture.h"
#include "kernel/sculpture_check.h"
#include "kernel/tool/tool.h"
#include "tests/support/shuffled_workers.h"
#include "tests/support/test.h"
#include "tests/support/thread_workers.h"

namespace kerf::motion_window_test {
namespace {

constexpr double kSide = 40, kTop = 20;

SculptureSettings settings_of(Rays rays, ForceLaw law) {
  return SculptureSettings{
      .stock = BoxStock{{0, 0, 0}, {kSide, kSide, kTop}},
      .rays = rays,
      .pitch_mm = 0.25,
      .tolerance_mm = 0.005,
      .keep_normals = true,
      .force = {.law = law, .pivot_mm = 40, .milling = {.cut_n_per_mm2 = {600, 200, 100}}}};
}

Sculpture block(const SculptureSettings& settings) {
  auto s = *Sculpture::create(settings);
  ToolBody body{.shank = Shank{.diameter_mm = 9, .length_mm = 20}};
  s.apply(DefineTool{1, *make_tool(BallShape{6, 30})}).value();
  s.apply(DefineTool{2, *make_tool(FlatShape{5, 25})}).value();
  s.apply(DefineTool{3, *make_tool(BullNoseShape{6, 1, 25})}).value();
  // Its shank touches the stock at most depths.
  s.apply(DefineTool{4, *make_tool(BallShape{6, 4}, body)}).value();
  return s;
}

/// Motions of participants that move in turn, near each other or apart. Occasionally one jumps.
std::vector<MoveTool> random_motions(std::mt19937& random, int participants, int count,
                                     double apart) {
  const test::Uniform in(random);
  const auto axis = [&] { return normalized(Vec3{in(-0.2, 0.2), in(-0.2, 0.2), 1}); };
  struct Hand {
    ToolPose at;
    Vec3 home;
  };
  std::vector<Hand> hands;
  for (int p = 0; p < participants; ++p) {
    const double angle = 6.28 * p / participants;
    const Vec3 home{kSide / 2 + apart * std::cos(angle), kSide / 2 + apart * std::sin(angle), 0};
    hands.push_back({{home + Vec3{0, 0, in(12, 19)}, axis()}, home});
  }
  std::vector<MoveTool> moves;
  for (int n = 0; n < count; ++n) {
    Hand& hand = hands[std::size_t(n) % hands.size()];
    const auto place = [&] { return hand.home + Vec3{in(-6, 6), in(-6, 6), in(11, 20)}; };
    if (in(0, 1) < 0.05) hand.at = {place(), axis()};
    const bool turns = in(0, 1) < 0.5;
    const Vec3 step{in(-2, 2), in(-2, 2), in(-0.5, 0.5)};
    const ToolPose to{in(0, 1) < 0.1 ? place() : hand.at.tip_mm + step,
                      turns ? axis() : hand.at.axis};
    moves.push_back({.tool = ToolId(1 + n % 4),
                     .from = hand.at,
                     .to = to,
                     .duration_s = 0.001,
                     .feel = in(0, 1) < 0.8});
    hand.at = to;
  }
  return moves;
}

void expect_same(const MotionResult& a, const MotionResult& b) {
  EXPECT_EQ(a.wrench, b.wrench);
  EXPECT_EQ(a.collision, b.collision);
  EXPECT_EQ(a.cutting.engaged_area_mm2, b.cutting.engaged_area_mm2);
  EXPECT_EQ(a.cutting.direction, b.cutting.direction);
  EXPECT_EQ(a.cutting.center_mm, b.cutting.center_mm);
  EXPECT_EQ(a.stock_contact_mm, b.stock_contact_mm);
  EXPECT_EQ(a.removed_mm3, b.removed_mm3);
  EXPECT_EQ(a.imprint_mm3, b.imprint_mm3);
  EXPECT_EQ(a.sub_motions, b.sub_motions);
  EXPECT_EQ(a.changed_tiles, b.changed_tiles);
  EXPECT_EQ(a.cut_tiles, b.cut_tiles);
}

/// Compares the normals of the ends, which the state hash excludes.
void expect_same_normals(const Sculpture& a, const Sculpture& b, Rays rays) {
  for (const RayAxis axis : axes_of(rays)) {
    const DexelGrid& grid = a.field(axis)->grid();
    for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
      for (std::int32_t x = 0; x < grid.tiles_x(); ++x) {
        const DexelTile *of_a = a.field(axis)->find({x, y}), *of_b = b.field(axis)->find({x, y});
        ASSERT_EQ(of_a == nullptr, of_b == nullptr);
        if (of_a == nullptr) continue;
        for (int c = 0; c < kTileColumns; ++c) {
          const auto column = std::size_t(c);
          if (of_a->bottom[column] == of_a->top[column]) continue;
          ASSERT_EQ(of_a->topmost_codes[column].top, of_b->topmost_codes[column].top);
          ASSERT_EQ(of_a->topmost_codes[column].bottom, of_b->topmost_codes[column].bottom);
        }
      }
    }
  }
}

/// Applies motions in windows of random sizes, with occasional snapshots.
std::vector<MotionResult> apply_together(Sculpture& s, std::span<const MoveTool> moves,
                                         Workers& workers, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<MotionResult> results;
  while (!moves.empty()) {
    const std::size_t count =
        std::min(std::uniform_int_distribution<std::size_t>(1, 24)(random), moves.size());
    std::ranges::move(s.apply(moves.first(count), workers), std::back_inserter(results));
    if (random() % 3 == 0) (void)s.solid();
    moves = moves.subspan(count);
  }
  return results;
}

class MotionWindows : public testing::TestWithParam<std::tuple<Rays, ForceLaw>> {};

TEST_P(MotionWindows, EqualSequentialMotionsToTheBit) {
  const auto [rays, law] = GetParam();
  for (const double apart : {2.0, 12.0}) {
    SCOPED_TRACE(apart);
    std::mt19937 random(unsigned(apart) + 1);
    const std::vector<MoveTool> moves = random_motions(random, 5, 90, apart);
    Sculpture expected = block(settings_of(rays, law));
    std::vector<MotionResult> results;
    for (const MoveTool& move : moves) results.push_back(expected.apply(move).value());
    ASSERT_TRUE(std::ranges::any_of(results, [](auto& r) { return r.stock_contact_mm > 0; }));
    ASSERT_TRUE(std::ranges::any_of(results, [](auto& r) { return r.imprint_mm3 > 0; }));
    ASSERT_GT(expected.state_hash(), 0U);
    SerialWorkers one;
    test::ThreadWorkers two(2), five(5);
    test::ShuffledWorkers shuffled;
    Workers* const workers[] = {&one, &two, &five, &shuffled};
    for (std::size_t w = 0; w < std::size(workers); ++w) {
      SCOPED_TRACE("workers " + std::to_string(w));
      Sculpture s = block(settings_of(rays, law));
      const auto together = apply_together(s, moves, *workers[w], unsigned(w));
      ASSERT_EQ(together.size(), results.size());
      for (std::size_t n = 0; n < results.size(); ++n) {
        SCOPED_TRACE("motion " + std::to_string(n));
        expect_same(together[n], results[n]);
      }
      EXPECT_EQ(s.state_hash(), expected.state_hash());
      EXPECT_EQ(s.removed_volume_mm3(), expected.removed_volume_mm3());
      EXPECT_EQ(s.imprint_volume_mm3(), expected.imprint_volume_mm3());
      EXPECT_EQ(s.sub_motions(), expected.sub_motions());
      expect_same_normals(s, expected, rays);
    }
    EXPECT_GT(shuffled.runs(), 0);
    EXPECT_GT(two.runs(), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, MotionWindows,
                         testing::Combine(testing::Values(Rays::kDexel, Rays::kTriDexel),
                                          testing::Values(ForceLaw::kSpecificEnergy,
                                                          ForceLaw::kMechanistic)));

// Normals are resolved in batches of sweeps, in small steps, and the tiles are divided among the
// threads.
TEST(MotionWindow, NormalsDoNotDependOnThreads) {
  const SculptureSettings settings = settings_of(Rays::kDexel, ForceLaw::kSpecificEnergy);
  std::mt19937 random(3);
  const std::vector<MoveTool> moves = random_motions(random, 5, 800, 12);
  Sculpture expected = block(settings);
  for (std::size_t n = 0; n < moves.size(); ++n) {
    expected.apply(moves[n]).value();
    if (n % 50 == 0) (void)expected.solid();
  }
  (void)expected.solid();
  test::ThreadWorkers two(2);
  test::ShuffledWorkers shuffled;
  for (Workers* workers : {static_cast<Workers*>(&two), static_cast<Workers*>(&shuffled)}) {
    Sculpture s = block(settings);
    for (std::size_t first = 0; first < moves.size(); first += 20) {
      s.apply(std::span(moves).subspan(first, 20), *workers);
    }
    (void)s.solid();
    expect_same_normals(s, expected, settings.rays);
  }
}

TEST(MotionWindow, MotionsBeyondTheSweepLimitAreCutInParts) {
  SculptureSettings settings = settings_of(Rays::kTriDexel, ForceLaw::kSpecificEnergy);
  settings.motion = MotionModel::kPaper;
  settings.keep_normals = false;
  settings.tolerance_mm = 0.008;
  const std::vector<MoveTool> moves{
      {1, {{5, 20, 17}, {0, 0, 1}}, {{30, 20, 17}, normalized({0.3, 0, 1})}, 0.1},
      {1, {{30, 20, 17}, normalized({0.3, 0, 1})}, {{30, 30, 15}, {0, 0, 1}}, 0.1}};
  Sculpture one = block(settings), together = block(settings);
  test::ThreadWorkers three(3);
  const auto results = together.apply(moves, three);
  EXPECT_GT(results[0].sub_motions, 300U);
  for (std::size_t n = 0; n < moves.size(); ++n) {
    expect_same(results[n], one.apply(moves[n]).value());
  }
  EXPECT_EQ(together.state_hash(), one.state_hash());
}

/// A square plate, 1 mm thick, and a cutter that is wider.
Sculpture plate(double side_mm, double pitch_mm, ForceLaw law) {
  SculptureSettings settings = settings_of(Rays::kDexel, law);
  settings.stock = BoxStock{{0, 0, 0}, {side_mm, side_mm, 1}};
  settings.pitch_mm = pitch_mm;
  settings.keep_normals = false;
  auto s = *Sculpture::create(settings);
  s.apply(DefineTool{1, *make_tool(FlatShape{1000, 50})}).value();
  return s;
}

MoveTool plunge(double side_mm, double depth_mm) {
  const Vec3 middle{side_mm / 2 + 3, side_mm / 2 - 5, 2};
  return {1, {middle, {0, 0, 1}}, {{middle.x, middle.y, 1 - depth_mm}, {0, 0, 1}}, 0.1, true};
}

TEST(MotionWindow, SweepsLargerThanAWindowAreFeltAsAWhole) {
  for (const ForceLaw law : {ForceLaw::kSpecificEnergy, ForceLaw::kMechanistic}) {
    // 67 x 67 tiles of 3.2 mm, and 34 x 34 of 6.4 mm.
    Sculpture fine = plate(214.4, 0.1, law), coarse = plate(214.4, 0.2, law);
    const MotionResult parts = fine.apply(plunge(214.4, 0.25)).value();
    const MotionResult whole = coarse.apply(plunge(214.4, 0.25)).value();
    EXPECT_NEAR(parts.removed_mm3, 214.4 * 214.4 * 0.25, 1e-3);
    EXPECT_EQ(parts.cut_tiles.size(), 67U * 67U);
    EXPECT_EQ(parts.cutting.engaged_area_mm2 > 0, whole.cutting.engaged_area_mm2 > 0);
    EXPECT_NEAR(parts.cutting.engaged_area_mm2, whole.cutting.engaged_area_mm2, 1e-3);
    // The mechanistic law divides the edge, which is as wide as the cut, by the pitch.
    const double share = law == ForceLaw::kMechanistic ? 0.1 : 1e-6;
    const double force = length(whole.wrench.force_n), torque = length(whole.wrench.torque_nmm);
    EXPECT_GT(force, 1);
    EXPECT_NEAR(length(parts.wrench.force_n - whole.wrench.force_n), 0, share * force);
    EXPECT_NEAR(length(parts.wrench.torque_nmm - whole.wrench.torque_nmm), 0, share * torque);
  }
}

TEST(MotionWindow, MemoryIsBoundedByOneWindow) {
  // The cutter reaches 157 x 157 tiles by less than a quantum, so that no tile is created.
  Sculpture s = plate(500, 0.1, ForceLaw::kSpecificEnergy);
  const std::size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
  const MotionResult result = s.apply(plunge(500, 1e-10)).value();
  EXPECT_EQ(result.removed_mm3, 0);
  EXPECT_LT(mallinfo2().uordblks + mallinfo2().hblkhd, before + 10'000'000);
}

TEST(MotionWindow, IsEmptyWithoutMotions) {
  Sculpture s = block(settings_of(Rays::kDexel, ForceLaw::kSpecificEnergy));
  SerialWorkers one;
  EXPECT_TRUE(s.apply(std::span<const MoveTool>{}, one).empty());
  EXPECT_EQ(s.motions(), 0U);
}

}  // namespace
}  // namespace kerf::motion_window_test
