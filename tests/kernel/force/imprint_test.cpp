// SPDX-License-Identifier: Apache-2.0
// Material inside a tool where a motion begins is an imprint, not a cut: it is removed, reported
// and gives no force.

#include "kernel/cut/imprint.h"

#include "kernel/sculpture.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/support/test.h"
#include "tests/support/thread_workers.h"

namespace kerf::imprint_test {
namespace {

const Vec3 kUp{0, 0, 1};
const Vec3 kPlace{0.0371, 0.0213, -5.03};
constexpr double kTickS = 0.001, kStepMm = 0.03;

struct Case {
  Rays rays = Rays::kDexel;
  ForceLaw law = ForceLaw::kSpecificEnergy;
  MotionModel motion = MotionModel::kTight;
  double pitch_mm = 0.2;
  double tolerance_mm = 0.001;
};

Sculpture block(const Case& c, const Tool& tool) {
  auto sculpture = *Sculpture::create({.stock = BoxStock{{-9, -9, -14}, {9, 9, 0}},
                                       .rays = c.rays,
                                       .pitch_mm = c.pitch_mm,
                                       .tolerance_mm = c.tolerance_mm,
                                       .motion = c.motion,
                                       .force = {c.law, 0.5, 0.01, 60}});
  sculpture.apply(DefineTool{1, tool}).value();
  return sculpture;
}

Sculpture block(const Case& c, const ToolShape& shape) { return block(c, *make_tool(shape)); }

std::vector<Case> every_case() {
  std::vector<Case> all;
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const ForceLaw law : {ForceLaw::kSpecificEnergy, ForceLaw::kDexelRemovalRate}) {
      all.push_back({rays, law});
    }
  }
  return all;
}

std::string name_of(const Case& s, const std::string& tool) {
  return tool + ' ' + to_string(s.rays) +
         (s.law == ForceLaw::kSpecificEnergy ? " specific" : " drr");
}

MotionResult move(Sculpture& s, const ToolPose& from, const ToolPose& to, bool feel = true,
                  ToolId tool = 1) {
  return s.apply(MoveTool{tool, from, to, kTickS, feel}).value();
}

/// Returns the results of ticks from `start` in a direction.
std::vector<MotionResult> ticks(Sculpture& s, Vec3 start, Vec3 direction, int count,
                                ToolId tool = 1, double step_mm = kStepMm) {
  std::vector<MotionResult> results;
  for (int i = 0; i < count; ++i) {
    results.push_back(move(s, {start + direction * (i * step_mm), kUp},
                           {start + direction * ((i + 1) * step_mm), kUp}, true, tool));
  }
  return results;
}

/// Expects no tick's force or torque above 1.5 times the mean of the last half.
void expect_no_spike(const std::vector<MotionResult>& results, const std::string& what) {
  const std::size_t half = results.size() / 2;
  double force = 0, torque = 0;
  for (std::size_t i = half; i < results.size(); ++i) {
    force += length(results[i].wrench.force_n) / double(results.size() - half);
    torque += length(results[i].wrench.torque_nmm) / double(results.size() - half);
  }
  ASSERT_GT(force, 0) << what;
  for (const MotionResult& r : results) {
    ASSERT_LT(length(r.wrench.force_n), 1.5 * force) << what;
    ASSERT_LT(length(r.wrench.torque_nmm), 1.5 * torque) << what;
  }
}

TEST(Imprint, ToolAtRestRemovesOnlyImprint) {
  for (const Case& c : every_case()) {
    for (const auto& [name, tool] : test::every_tool(0.6)) {
      auto s = block(c, tool);
      const ToolPose pose = test::leaning(kPlace, 0.2, 0.7);
      const MotionResult r = move(s, pose, pose);
      EXPECT_GT(r.removed_mm3, 1) << name_of(c, name);
      EXPECT_EQ(r.imprint_mm3, r.removed_mm3) << name_of(c, name);
      EXPECT_EQ(r.wrench, Wrench{}) << name_of(c, name);
      EXPECT_EQ(r.cutting.engaged_area_mm2, 0) << name_of(c, name);
    }
  }
}

TEST(Imprint, HasTheVolumeOfTheBuriedTool) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const double depth = -kPlace.z;
    const double ball = M_PI * (2.0 / 3 * 27 + 9 * (depth - 3)), flat = M_PI * 9 * depth;
    for (const auto& [shape, volume] :
         {std::pair<ToolShape, double>{BallShape{6, 20}, ball}, {FlatShape{6, 20}, flat}}) {
      auto s = block({.rays = rays, .pitch_mm = 0.1}, shape);
      const MotionResult r = move(s, {kPlace, kUp}, {kPlace + Vec3{1, 0, 0}, kUp});
      // The depth is 50.3 pitches, of which fields across the spindle see 50.
      EXPECT_NEAR(r.imprint_mm3 / volume, 1, 0.3 / 50.3);
      const double cut = shape.index() == 0 ? M_PI * 9 / 2 + 6 * (depth - 3) : 6 * depth;
      EXPECT_NEAR((r.removed_mm3 - r.imprint_mm3) / cut, 1, 0.02);
      EXPECT_EQ(s.imprint_volume_mm3(), r.imprint_mm3);
    }
  }
}

/// Moves a tool in a block where its start is free, because it stood there before without force,
/// and in one where it is buried. Compares imprint, force and torque.
void expect_same_as_free(const Case& c, const Tool& tool, const ToolPose& from, const ToolPose& to,
                         const std::string& what) {
  auto buried = block(c, tool), free = block(c, tool);
  const double imprint = move(free, from, from, false).removed_mm3;
  const MotionResult expected = move(free, from, to);
  const MotionResult r = move(buried, from, to);
  // One field sums equal elements. Three fields weight them, at one or two points of an element
  // depending on its neighbors, which differs by 0.003 here.
  const double share = c.rays == Rays::kDexel ? 1e-6 : 1e-2;
  const double force = length(expected.wrench.force_n);
  const double torque = length(expected.wrench.torque_nmm);
  EXPECT_NEAR(r.imprint_mm3, imprint, share * imprint) << what;
  EXPECT_LT(length(r.wrench.force_n - expected.wrench.force_n), share * force) << what;
  EXPECT_LT(length(r.wrench.torque_nmm - expected.wrench.torque_nmm), share * torque) << what;
  EXPECT_EQ(expected.imprint_mm3, 0) << what;
}

TEST(Imprint, BuriedMotionHasTheForceOfAFreeOne) {
  std::mt19937_64 random(3);
  const test::Uniform in(random);
  for (Case c : every_case()) {
    for (const auto& [name, tool] : test::every_tool(0.6)) {
      const ToolPose from = test::leaning(kPlace, in(0, 0.4), in(0, 6.2));
      const Vec3 to = kPlace + Vec3{in(-1, 1), in(-1, 1), in(-1, 1)} * in(0, 2);
      const Vec3 axis = test::turned(from.axis, {in(-1, 1), in(-1, 1), 0}, in(0, 0.3));
      expect_same_as_free(c, tool, from, {to, from.axis}, name_of(c, name));
      expect_same_as_free(c, tool, from, {to, axis}, name_of(c, name) + " turning");
      if (name != "ball" && name != "flat") continue;
      c.motion = MotionModel::kPaper;
      c.tolerance_mm = 0.05;
      expect_same_as_free(c, tool, from, {to, axis}, name_of(c, name) + " as in the paper");
      c = {.rays = c.rays, .law = c.law};
    }
  }
}

TEST(Imprint, BuriedStartHasNoForceSpike) {
  for (const Case& c : every_case()) {
    for (const auto& [name, tool] : test::every_tool(0.6)) {
      for (const Vec3 direction : {Vec3{0.8, 0.6, 0}, Vec3{0.6, 0, -0.8}}) {
        auto s = block(c, tool);
        const auto felt = ticks(s, kPlace, direction, 30);
        expect_no_spike(felt, name_of(c, name));
        EXPECT_GT(felt[0].imprint_mm3, 1);
        for (std::size_t i = 1; i < felt.size(); ++i) ASSERT_EQ(felt[i].imprint_mm3, 0);
      }
    }
  }
}

TEST(Imprint, LargerToolInASlotHasNoForceSpike) {
  for (const Case& c : every_case()) {
    for (const bool redefined : {false, true}) {
      auto s = block(c, FlatShape{4, 40});
      const Vec3 start{-12, kPlace.y, -3};
      const auto slot = ticks(s, start, {1, 0, 0}, 400);
      const ToolId larger = redefined ? 1 : 2;
      s.apply(DefineTool{larger, *make_tool(FlatShape{7, 40})}).value();
      const Vec3 at = start + Vec3{1, 0, 0} * (400 * kStepMm);
      const auto felt = ticks(s, at, {1, 0, 0}, 60, larger);
      expect_no_spike(felt, name_of(c, "flat"));
      EXPECT_GT(felt[0].imprint_mm3, 10);
      EXPECT_EQ(slot.back().imprint_mm3, 0);
    }
  }
}

TEST(Imprint, LiftingABuriedToolOutGivesNoForce) {
  for (const Case& c : every_case()) {
    for (const ToolShape& shape : {ToolShape{FlatShape{6, 40}}, ToolShape{BallShape{6, 40}},
                                   ToolShape{BullNoseShape{6, 1.5, 40}}}) {
      for (const Vec3 axis : {kUp, test::leaning({}, 0.3, 1).axis}) {
        auto s = block(c, shape);
        for (int i = 0; i < 50; ++i) {
          const MotionResult r =
              move(s, {kPlace + axis * (i * 0.12), axis}, {kPlace + axis * ((i + 1) * 0.12), axis});
          ASSERT_LT(length(r.wrench.force_n), 1e-3) << name_of(c, "") << i;
        }
      }
    }
  }
}

TEST(Imprint, TremorInsideStockGivesNoForce) {
  for (const Case& c : every_case()) {
    for (const auto& [name, tool] : test::every_tool(0.6)) {
      for (const double step_mm : {1e-12, 1e-9, 1e-6}) {
        auto s = block(c, tool);
        for (const MotionResult& r : ticks(s, kPlace, {0.8, 0.6, 0}, 20, 1, step_mm)) {
          ASSERT_LT(length(r.wrench.force_n), 0.05) << name_of(c, name) << ' ' << step_mm;
        }
      }
    }
  }
}

TEST(Imprint, IsZeroForStartsOutsideTheStock) {
  for (const Case& c : every_case()) {
    for (const auto& [name, tool] : test::every_tool(0.6)) {
      auto s = block(c, tool);
      // The tip starts above the stock, and on its surface.
      for (const double z : {1.0, 0.0}) {
        const Vec3 start{z * 4, 0, z};
        const MotionResult r = move(s, {start, kUp}, {start + Vec3{0, 0, -3}, kUp});
        EXPECT_GT(r.removed_mm3, 0.1) << name_of(c, name);
        EXPECT_EQ(r.imprint_mm3, 0) << name_of(c, name) << ' ' << z;
      }
    }
  }
}

TEST(Imprint, IsExactlyZeroForContinuingMotions) {
  // Two users of one tool take turns; some motions are not felt.
  std::mt19937_64 random(17);
  const auto unit = [&] { return double(random() % 2001) / 1000 - 1; };
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const auto& [name, tool] : test::every_tool(0.6)) {
      auto s = block({.rays = rays}, tool);
      ToolPose users[] = {{{-3, 0, 1}, kUp}, {{3, 0, 1}, kUp}};
      double removed = 0;
      for (int i = 0; i < 30; ++i) {
        ToolPose& at = users[i % 2];
        const ToolPose to{at.tip_mm + Vec3{unit(), unit(), unit() - 0.5} * 0.3,
                          normalized(at.axis + Vec3{unit(), unit(), 0} * 0.05)};
        const MotionResult r = move(s, at, to, random() % 3 != 0);
        ASSERT_EQ(r.imprint_mm3, 0) << name;
        removed += r.removed_mm3;
        at = to;
      }
      EXPECT_GT(removed, 0.5) << name;
    }
  }
}

TEST(Imprint, RestoredStockIsImprintAgain) {
  // A block that is rebuilt holds the stock that the tool had removed.
  const ToolPose at{kPlace, kUp}, next{kPlace + Vec3{0.03, 0, 0}, kUp};
  for (int round = 0; round < 2; ++round) {
    auto s = block({}, FlatShape{6, 40});
    EXPECT_GT(move(s, at, next).imprint_mm3, 100);
    EXPECT_EQ(move(s, next, at).imprint_mm3, 0);
  }
}

TEST(Imprint, DividesElementsAtEveryIntervalOfAColumn) {
  // Two discs on a thin neck: a ray next to the neck meets the tool twice. The removed element
  // reaches beyond both, so three parts remain.
  const Tool dumbbell =
      *make_tool(ProfileShape{{ProfilePoint{2, 0}, ProfilePoint{2, 1}, ProfilePoint{0.5, 1},
                               ProfilePoint{0.5, 3}, ProfilePoint{2, 3}, ProfilePoint{2, 4}}});
  const DexelGrid grid{{0, 0, 0}, 0.5, 0.01, 16, 16, 1000};
  const ToolMotion rest =
      make_motion({{3.25, 3.25, 2}, kUp}, {{3.25, 3.25, 2}, kUp}, dumbbell.length_mm);
  Removal removal;
  RemovedPart& part = removal.start(1).front();
  RemovedGroup group{0, 6, {}, {}};
  group.bottom[6] = group.bottom[3] = 50;  // columns at the axis and 1.5 mm from it
  group.top[6] = group.top[3] = 900;
  part.groups = {group};
  part.tiles = {{{0, 0}, 1}};
  part.quanta = 2 * 850;
  std::int64_t taken = 0;
  sweep_tool(dumbbell, rest, {MotionModel::kTight, 0.001, {{0, 0, 0}, {8, 8, 10}}},
             [&](const SubMotion& standing) { taken = take_imprint(standing.swept, grid, part); });
  EXPECT_EQ(taken, 400 + 200);
  EXPECT_EQ(removal.quanta(), 2 * 850 - taken);
  std::vector<std::pair<int, int>> axis, beside;
  for (const RemovedGroup& g : removal.parts().front().of(0)) {
    if (g.bottom[6] < g.top[6]) axis.emplace_back(g.bottom[6], g.top[6]);
    if (g.bottom[3] < g.top[3]) beside.emplace_back(g.bottom[3], g.top[3]);
  }
  std::ranges::sort(beside);
  EXPECT_EQ(axis, (std::vector<std::pair<int, int>>{{50, 200}, {600, 900}}));
  EXPECT_EQ(beside, (std::vector<std::pair<int, int>>{{50, 200}, {300, 500}, {600, 900}}));
}

TEST(Imprint, DoesNotDependOnTheNumberOfThreads) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    for (const auto& [name, tool] : test::every_tool(0.6)) {
      const MoveTool command{1, test::leaning(kPlace, 0.3, 1),
                             test::leaning(kPlace + Vec3{2, 1, -1}, 0.1, 2), kTickS};
      auto one = block({.rays = rays}, tool), several = block({.rays = rays}, tool);
      test::ThreadWorkers workers(3);
      const MotionResult a = one.apply(command).value();
      const MotionResult b = several.apply(command, workers).value();
      EXPECT_GT(a.imprint_mm3, 1) << name;
      EXPECT_EQ(a.imprint_mm3, b.imprint_mm3) << name;
      EXPECT_EQ(a.wrench, b.wrench) << name;
    }
  }
}

}  // namespace
}  // namespace kerf::imprint_test
