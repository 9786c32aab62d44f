// SPDX-License-Identifier: Apache-2.0
// From micrometers to ten meters: pitches, blocks, offsets, tools, travels, turns and cones at both
// ends of their ranges, each compared with the true sweep.

#include "tests/kernel/extremes/carving.h"
#include "tests/support/test.h"

namespace kerf::test::range_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr Vec3 kUp{0, 0, 1};

/// One motion in one block, all lengths in mm.
struct Scene {
  double block_width = 40, block_height = 20, pitch = 0.9, tolerance = 1e-3;
  Vec3 top_center;
  double depth = 4;  ///< of the tip below the top
  double travel = 3, turn = 0, lean = 0.2;
};

void judge(const Scene& scene, const Tool& tool, const std::string& what, int columns = 25) {
  Carving carving(
      block(scene.block_width, scene.block_height, scene.pitch, scene.tolerance, scene.top_center),
      tool);
  const Vec3 middle = scene.top_center + Vec3{0.01, -0.02, -1} * scene.depth;
  const Vec3 half = normalized({0.8, 0.55, -0.05}) * (scene.travel / 2);
  const ToolPose from = leaning(middle - half, scene.lean, 0.6);
  const ToolPose to{middle + half,
                    scene.turn == 0 ? from.axis : turned(from.axis, {0.3, 1, 0.4}, scene.turn)};
  carving.move(from, to);
  carving.expect_within_tolerance(what, columns);
}

std::string with(const NamedTool& t, const char* what, double value) {
  char text[100];
  std::snprintf(text, sizeof text, "%s, %s %g", t.name.c_str(), what, value);
  return text;
}

TEST(Range, PitchesFromAMicrometreToTenMillimetres) {
  for (const double pitch : {1e-3, 0.01, 0.1, 1.0, 10.0}) {
    const double size = pitch * 150;  // A tool of 30 pitches in a block of 150.
    for (const NamedTool& t : every_tool(3 * pitch)) {
      for (const double turn : {0.0, 0.2}) {
        Scene s{.block_width = size,
                .block_height = size / 2,
                .pitch = pitch,
                .tolerance = 2e-4 * pitch + 1e-6,
                .depth = 12 * pitch,
                .travel = 15 * pitch,
                .turn = turn};
        judge(s, t.tool, with(t, "pitch", pitch));
      }
    }
  }
}

TEST(Range, BlocksFromAMillimetreToTenMetresFarFromTheOrigin) {
  for (const double size : {1.0, 30.0, 1000.0, 1e4}) {
    for (const Vec3 offset : {Vec3{}, Vec3{1e4, 1e4, 1e4}, Vec3{-1e4, 1e4, -9999.7}}) {
      for (const NamedTool& t : every_tool(std::min(1.0, size / 30))) {
        const double r = t.tool.radius_mm;
        for (const double turn : {0.0, 0.3}) {
          Scene s;
          s.block_width = s.block_height = size;
          s.pitch = r / 9;
          s.top_center = offset;
          s.depth = 0.6 * r;
          s.travel = r;
          s.turn = turn;
          s.tolerance = 1e-4;
          judge(s, t.tool, with(t, "block", size), 12);
        }
      }
    }
  }
}

TEST(Range, ToolsFromAHundredthOfAMillimetreToHalfAMetre) {
  for (const double diameter : {0.01, 0.1, 1.0, 100.0, 500.0}) {
    for (const NamedTool& t : every_tool(diameter / 10)) {
      for (const double turn : {0.0, 0.1, 1.0}) {
        Scene s{.block_width = 4 * diameter,
                .block_height = 2 * diameter,
                .pitch = diameter / 15,
                .tolerance = 1e-4 * diameter + 1e-6,
                .depth = 0.4 * diameter,
                .travel = 0.3 * diameter,
                .turn = turn};
        judge(s, t.tool, with(t, "diameter", diameter));
      }
    }
  }
}

TEST(Range, TinyToolsInLargeBlocksAndLargeToolsInTinyBlocks) {
  for (const NamedTool& t : every_tool(1e-3)) {
    Scene s{.block_width = 0.1,
            .block_height = 1000,
            .pitch = 0.0013,
            .tolerance = 1e-6,
            .depth = 0.004,
            .travel = 0.02};
    judge(s, t.tool, t.name + " of 0.01 mm");
  }
  for (const NamedTool& t : every_tool(50)) {
    for (const double turn : {0.0, 0.002}) {
      Scene s;
      s.block_width = s.block_height = 1;
      s.pitch = 0.021;
      s.tolerance = 1e-4;
      s.depth = 0.3;
      s.travel = 0.5;
      s.turn = turn;
      s.lean = 0.03;
      judge(s, t.tool, t.name + " of 500 mm");
    }
  }
}

TEST(Range, TravelsFromANanometerToTenMeters) {
  for (const NamedTool& t : every_tool()) {
    for (const double travel : {1e-9, 1e-6, 1e-3, 30.0, 1e4}) {
      for (const double turn : {0.0, 1e-6, 0.4}) {
        Scene s{.tolerance = 0.005, .travel = travel, .turn = turn};
        judge(s, t.tool, with(t, "travel", travel) + (turn > 0 ? " turning" : ""));
      }
    }
  }
}

TEST(Range, TurnsFromAPicoradianTo170Degrees) {
  for (const NamedTool& t : every_tool()) {
    for (const double turn : {1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 2.0, 169.99 * kPi / 180}) {
      for (const double travel : {0.0, 2.0}) {
        Scene s{.tolerance = 0.01, .travel = travel, .turn = turn};
        judge(s, t.tool, with(t, "turn", turn), 15);
      }
    }
  }
}

TEST(Range, ConesFromAHundredthOfADegreeToNearlyARightAngle) {
  for (const double half_angle : {0.01, 0.1, 1.0, 45.0, 80.0, 89.0, 89.99}) {
    // Long cones for steep angles, short ones for flat angles, so that the upper radius stays
    // small.
    const double length = std::min(40.0, 6 / std::tan(half_angle * kPi / 180));
    for (const double direction : {0.0, 1.0, -1.0}) {
      for (const double turn : {0.0, 0.15}) {
        Scene s{.depth = std::min(4.0, length), .travel = 3 * direction, .turn = turn, .lean = 0.1};
        judge(s, *make_tool(TaperShape{2, half_angle, length}),
              "half angle " + std::to_string(half_angle) + " turn " + std::to_string(turn));
      }
    }
  }
}

/// Each removed end may differ by the rounding to a quantum only.
TEST(Range, GrazingRaysWithinOneBit) {
  const SculptureSettings s = block(20, 12, 0.5, 1e-6);
  for (const NamedTool& t : every_tool()) {
    const double r = t.tool.radius_mm;
    for (const double z :
         {0.0, std::nextafter(0.0, kInf) * 1e308, 1e-300, -1e-300, -1e-17, -1e-12}) {
      Carving carving(s, t.tool);
      const double taken = carving.move({{-5, 0.25, z}, kUp}, {{5, 0.25, z}, kUp}).removed_mm3;
      EXPECT_EQ(taken, 0) << t.name << " at " << z;
    }
    for (const double side : {-10 - r, std::nextafter(-10 - r, kInf),
                              std::nextafter(-10 - r, -kInf), -10 - r + 1e-12}) {
      Carving carving(s, t.tool);
      carving.move({{side, -6, -4}, kUp}, {{side, 6, -4}, kUp});
      carving.expect_within_tolerance(t.name + " beside the block");
    }
    // The first column is half a pitch inside: touch it from one bit below to one bit beyond.
    const double x = -10 + 0.25;
    for (const double side : {x - r, std::nextafter(x - r, kInf), std::nextafter(x - r, -kInf)}) {
      Carving carving(s, t.tool);
      carving.move({{side, -6, -8}, kUp}, {{side, 6, -8}, kUp});
      carving.expect_within_tolerance(t.name + " touching the first column");
    }
  }
}

TEST(Range, SmallStepsCutTheSameAsOneMotion) {
  for (const NamedTool& t : every_tool()) {
    const ToolPose a = leaning({-0.5, 0.1, -4}, 0.2);
    Carving steps(block(30, 16, 0.7, 1e-4), t.tool);
    constexpr int kSteps = 1000;
    const Vec3 step{1e-6, 3e-7, -2e-7};
    Vec3 tip = a.tip_mm;
    for (int i = 0; i < kSteps; ++i) {
      steps.sculpture().apply(MoveTool{1, {tip, a.axis}, {tip + step, a.axis}, 0.001}).value();
      tip = tip + step;
    }
    steps.judge_by(TrueSweep(t.tool, a, {tip, a.axis}));
    EXPECT_LE(steps.error_mm(40, 1), steps.rounding_mm()) << t.name << ' ' << steps.worst_place();
  }
}

TEST(Range, RepeatedCutsOfAPathDoNotDrift) {
  // The soak program repeats this a million times (tests/README.md).
  for (const NamedTool& t : every_tool()) {
    Carving carving(block(24, 12, 0.8, 0.01), t.tool);
    const ToolPose a = leaning({-3, 0.2, -3}, 0.2), b = leaning({3, 1, -4}, 0.5, 1);
    carving.move(a, b);
    const std::uint64_t state = carving.sculpture().state_hash();
    const double volume = carving.sculpture().removed_volume_mm3();
    for (int i = 0; i < 300; ++i) {
      ASSERT_EQ(carving.sculpture().apply(MoveTool{1, a, b, 0.01}).value().removed_mm3, 0);
    }
    EXPECT_EQ(carving.sculpture().state_hash(), state) << t.name;
    EXPECT_EQ(carving.sculpture().removed_volume_mm3(), volume) << t.name;
  }
}

}  // namespace
}  // namespace kerf::test::range_test
