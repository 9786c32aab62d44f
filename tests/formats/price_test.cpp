// SPDX-License-Identifier: Apache-2.0
#include "server/verify/price.h"

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::price_test {
namespace {

Scene scene_with(const std::string& rays, const std::string& kinematics = "tool-vector") {
  const std::string text =
      R"({"stock": {"shape": "box", "min_mm": [0, 0, -20], "max_mm": [80, 60, 0]},
          "accuracy": {"rays": ")" +
      rays + R"(", "pitch_mm": 0.25, "tolerance_mm": 0.01,
                       "motion": "tight"},
          "tools": [{"id": 1, "shape": "ball", "diameter_mm": 8, "length_mm": 40},
                    {"id": 2, "shape": "flat", "diameter_mm": 3, "length_mm": 40}],
          "machine": {"kinematics": ")" +
      kinematics + R"("}})";
  return parse_scene(text, {}).value();
}

/// Rows of `step_mm` over a part of the block, from x0 to x1.
std::vector<ProgramMotion> rows(double step_mm, double x0, double x1, ToolId tool = 1) {
  std::vector<ProgramMotion> motions;
  ToolPose last{{x0, 0, -2}, {0, 0, 1}};
  for (double y = 0; y <= 60; y += 1.5) {
    for (double x = x0; x <= x1; x += step_mm) {
      const ToolPose to{{x, y, -2 - std::sin(0.2 * x)}, {0, 0, 1}};
      motions.push_back({.tool = tool, .from = last, .to = to, .duration_s = 0.01});
      last = to;
    }
  }
  return motions;
}

double carved_bytes(const Scene& scene, const std::vector<ProgramMotion>& motions) {
  auto block = Sculpture::create(scene.settings).value();
  for (const auto& [id, tool] : scene.tools) block.apply(DefineTool{id, tool.tool}).value();
  for (const ProgramMotion& m : motions)
    block.apply(MoveTool{m.tool, m.from, m.to, m.duration_s, false}).value();
  return double(block.memory_bytes());
}

/// A meter whose clock advances by `step_s` at each call, without page faults.
CostMeter meter_of(double step_s = 1e-6) {
  return {.cpu_s = [step_s, now_s = 0.0]() mutable { return now_s += step_s; },
          .page_faults = [] { return std::int64_t{0}; },
          .page_fault_s = [] { return 0.0; }};
}

TEST(Price, MemoryScalesFromTheSampleToAllReachedTiles) {
  for (const char* rays : {"dexel", "tri-dexel"}) {
    const Scene scene = scene_with(rays);
    for (const auto& motions : {rows(0.5, 0, 80), rows(0.5, 0, 20), rows(0.1, 30, 60, 2)}) {
      const Price price = price_of_program(scene, motions, meter_of());
      const double carved = carved_bytes(scene, motions);
      EXPECT_GT(price.bytes, 0.7 * carved) << rays << ' ' << motions.size();
      EXPECT_LT(price.bytes, 1.5 * carved + 2e6) << rays << ' ' << motions.size();
    }
  }
}

TEST(Price, WindowsRepresentALongProgram) {
  const Scene scene = scene_with("dexel");
  const auto motions = rows(0.1, 0, 80);
  // By this clock the whole would exceed the time limit.
  const Price price = price_of_program(scene, motions, meter_of(1e-2));
  EXPECT_LT(price.motions, motions.size() / 4);
  const double carved = carved_bytes(scene, motions);
  EXPECT_GT(price.bytes, 0.7 * carved);
  EXPECT_LT(price.bytes, 1.5 * carved + 2e6);
}

TEST(Price, ShortProgramIsCarvedCompletely) {
  const Scene scene = scene_with("dexel");
  const auto motions = rows(2, 0, 80);
  ASSERT_LT(motions.size(), 1900U);
  const Price price = price_of_program(scene, motions, meter_of());
  EXPECT_EQ(price.motions, motions.size());
  const double carved = carved_bytes(scene, motions);
  EXPECT_GT(price.bytes, carved);
  EXPECT_LT(price.bytes, carved + 2e6);
  EXPECT_GT(price.us_per_motion, 0);
}

TEST(Price, EachPageOfTheBlockIsAccessedForTheFirstTimeOnce) {
  const Scene scene = scene_with("dexel");
  const auto motions = rows(2, 0, 80);
  const Price without = price_of_program(scene, motions, meter_of());
  // By this meter a page fault takes 10 µs, and each motion of the sample has some.
  constexpr double kFaultS = 1e-5;
  CostMeter meter = meter_of();
  meter.page_fault_s = [] { return kFaultS; };
  const Price none_seen = price_of_program(scene, motions, meter);
  const double pages = (without.bytes - carved_bytes(scene, {})) / 4096;
  EXPECT_NEAR(none_seen.us_per_motion - without.us_per_motion,
              1e6 * kFaultS * pages / double(motions.size()), 0.01);
  // Those that the sample had are in its CPU time already.
  double now_s = 0;
  std::int64_t faults = 0;
  meter.cpu_s = [&] {
    faults += 3;
    return now_s += 1e-6 + 3 * kFaultS;
  };
  meter.page_faults = [&] { return faults; };
  const Price seen = price_of_program(scene, motions, meter);
  EXPECT_NEAR(seen.us_per_motion, none_seen.us_per_motion, 0.01);
}

TEST(Price, SampleEndsAtItsTimeLimit) {
  const Scene scene = scene_with("dexel");
  const Price price = price_of_program(scene, rows(0.1, 0, 80), meter_of(0.5));
  EXPECT_GT(price.motions, 0U);
  EXPECT_LT(price.motions, 100U);
  EXPECT_GT(price.bytes, 0);
}

TEST(Price, AHandCarvesTheWholeBlock) {
  for (const char* rays : {"dexel", "tri-dexel"}) {
    const Scene scene = scene_with(rays);
    const Price price = price_of_hand(scene, meter_of());
    EXPECT_EQ(price.motions, sample_hand(scene).size());
    const double carved = carved_bytes(scene, rows(0.5, 0, 80));
    EXPECT_GT(price.bytes, 0.7 * carved) << rays;
    EXPECT_LT(price.bytes, 1.5 * carved + 2e6) << rays;
  }
  // A machine without rotary axes tilts no tool.
  for (const ProgramMotion& motion : sample_hand(scene_with("dexel", "xyz")))
    EXPECT_EQ(motion.to.axis, (Vec3{0, 0, 1}));
}

TEST(Price, EqualScenesGiveEqualSamples) {
  const Scene scene = scene_with("dexel");
  const auto motions = rows(0.1, 0, 80);
  const Price a = price_of_program(scene, motions, meter_of());
  const Price b = price_of_program(scene, motions, meter_of());
  EXPECT_EQ(a.bytes, b.bytes);
  EXPECT_EQ(a.motions, b.motions);
}

TEST(Price, ProgramOutsideTheBlockCostsTheEmptyBlock) {
  const Scene scene = scene_with("dexel");
  std::vector<ProgramMotion> motions = rows(0.5, 200, 220);
  const Price price = price_of_program(scene, motions, meter_of());
  EXPECT_LT(price.bytes, 1.1 * carved_bytes(scene, {}) + 2e6);
  EXPECT_EQ(price_of_program(scene, {}, meter_of()).motions, 0U);
}

}  // namespace
}  // namespace kerf::price_test
