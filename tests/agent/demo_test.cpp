// SPDX-License-Identifier: Apache-2.0
// The demo's programs carve the intended surface, without gouges and with little material left
// above it.

#include "haptic_agent/demo/ammonite.h"
#include "haptic_agent/demo/carving.h"
#include "haptic_agent/demo/height_map.h"
#include "haptic_agent/demo/stroke.h"
#include "tests/support/test.h"

namespace kerf::demo::demo_test {
namespace {

constexpr double kPitchMm = 0.4;

// Height map of the carved block, by brute force and independent of the offset surface that places
// the tools: balls at points of the axis, for every pose and between poses.
class Block {
 public:
  explicit Block(const Ammonite& ammonite)
      : min_(ammonite.block_min_mm),
        columns_(static_cast<int>((ammonite.block_max_mm.x - min_.x) / kPitchMm) + 1),
        rows_(static_cast<int>((ammonite.block_max_mm.y - min_.y) / kPitchMm) + 1),
        top_(static_cast<std::size_t>(columns_ * rows_), ammonite.block_max_mm.z) {}

  void cut(const Stroke& stroke, BallTool tool) {
    for (std::size_t i = 1; i < stroke.poses.size(); ++i) {
      const DemoPose &a = stroke.poses[i - 1], &b = stroke.poses[i];
      for (const double t : {0.0, 0.5}) {
        cut_pose({a.tip_mm * (1 - t) + b.tip_mm * t, normalized(a.axis * (1 - t) + b.axis * t)},
                 tool);
      }
    }
  }

  template <typename Visit>
  void for_each(Visit visit) const {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        visit(min_.x + column * kPitchMm, min_.y + row * kPitchMm,
              top_[static_cast<std::size_t>(row * columns_ + column)]);
      }
    }
  }

 private:
  void cut_pose(const DemoPose& pose, BallTool tool) {
    for (double s = tool.radius_mm; s < tool.length_mm; s += 0.7) {
      const Vec3 center = pose.tip_mm + pose.axis * s;
      if (center.z > tool.radius_mm) return;
      cut_ball(center, tool.radius_mm);
    }
  }

  void cut_ball(Vec3 center, double radius) {
    const auto bound = [](double mm, int limit) {
      return std::clamp(static_cast<int>(mm / kPitchMm), 0, limit - 1);
    };
    const int last_column = bound(center.x + radius - min_.x, columns_);
    const int last_row = bound(center.y + radius - min_.y, rows_);
    for (int row = bound(center.y - radius - min_.y, rows_); row <= last_row; ++row) {
      for (int column = bound(center.x - radius - min_.x, columns_); column <= last_column;
           ++column) {
        const double dx = min_.x + column * kPitchMm - center.x;
        const double dy = min_.y + row * kPitchMm - center.y;
        const double square = radius * radius - dx * dx - dy * dy;
        if (square < 0) continue;
        double& top = top_[static_cast<std::size_t>(row * columns_ + column)];
        top = std::min(top, center.z - std::sqrt(square));
      }
    }
  }

  Vec3 min_;
  int columns_, rows_;
  std::vector<double> top_;
};

// z of the surface's unit normal: the factor from a height difference to a distance from the
// surface.
double normal_z(const Ammonite& ammonite, double x, double y) {
  constexpr double kReachMm = 0.1;
  const double dx = (ammonite.height(x + kReachMm, y) - ammonite.height(x - kReachMm, y));
  const double dy = (ammonite.height(x, y + kReachMm) - ammonite.height(x, y - kReachMm));
  return normalized(Vec3{-dx, -dy, 2 * kReachMm}).z;
}

class DemoCarving : public testing::Test {
 protected:
  static const Carving& carving() {
    static const Carving kCarving = carve(Ammonite{});
    return kCarving;
  }
  static std::vector<Stroke> all_strokes() {
    std::vector<Stroke> strokes = carving().first;
    strokes.insert(strokes.end(), carving().second.begin(), carving().second.end());
    return strokes;
  }
};

TEST_F(DemoCarving, DoesNotGougeAndLeavesLittleMaterial) {
  const std::map<std::uint32_t, BallTool> tools = {
      {kCoarse.id, kCoarse}, {kShell.id, kShell}, {kFloor.id, kFloor}, {kFine.id, kFine}};
  const Ammonite ammonite;
  Block block(ammonite);
  for (const Stroke& stroke : all_strokes()) block.cut(stroke, tools.at(stroke.tool));

  double deepest_gouge_mm = 0, left_mm3 = 0, removed_mm3 = 0;
  block.for_each([&](double x, double y, double z) {
    const double target = ammonite.height(x, y);
    deepest_gouge_mm = std::max(deepest_gouge_mm, (target - z) * normal_z(ammonite, x, y));
    left_mm3 += std::max(0.0, z - target) * kPitchMm * kPitchMm;
    removed_mm3 += -z * kPitchMm * kPitchMm;
  });
  RecordProperty("deepest_gouge_um", static_cast<int>(deepest_gouge_mm * 1000));
  EXPECT_LT(deepest_gouge_mm, 0.1);
  EXPECT_GT(removed_mm3, 40'000);
  EXPECT_LT(left_mm3 / removed_mm3, 0.04);
}

TEST_F(DemoCarving, AxisTiltIsVisibleAndBounded) {
  double min_z = 1;
  for (const Stroke& stroke : all_strokes()) {
    for (const DemoPose& pose : stroke.poses) {
      ASSERT_NEAR(length(pose.axis), 1, 1e-9);
      min_z = std::min(min_z, pose.axis.z);
    }
  }
  EXPECT_LT(min_z, std::cos(0.5)) << "five-axis motion must be visible";
  EXPECT_GT(min_z, std::cos(0.8)) << "more tilt than the strokes require";
}

TEST_F(DemoCarving, DistancesBetweenPosesAreSmall) {
  for (const Stroke& stroke : all_strokes()) {
    for (std::size_t i = 1; i < stroke.poses.size(); ++i) {
      const DemoPose &a = stroke.poses[i - 1], &b = stroke.poses[i];
      EXPECT_LT(length(b.tip_mm - a.tip_mm), 8);
      EXPECT_GT(dot(a.axis, b.axis), std::cos(0.5));
    }
  }
}

TEST_F(DemoCarving, BothProgramsTakeThreeToFourMinutes) {
  for (const auto& strokes : {carving().first, carving().second}) {
    EXPECT_GT(cutting_seconds(strokes), 170);
    EXPECT_LT(cutting_seconds(strokes), 240);
  }
}

TEST_F(DemoCarving, HandsLiftEveryFewSecondsAndContinueInPlace) {
  for (const auto& strokes : {carving().first, carving().second}) {
    EXPECT_GT(strokes.size(), 20U);
    for (const Stroke& stroke : strokes) {
      EXPECT_GE(stroke.poses.size(), 2U);
      EXPECT_LE(cutting_seconds({stroke}), kStrokeSeconds);
    }
    int joined = 0;
    for (std::size_t n = 1; n < strokes.size(); ++n) {
      joined += strokes[n].poses.front().tip_mm == strokes[n - 1].poses.back().tip_mm ? 1 : 0;
    }
    EXPECT_GT(joined, static_cast<int>(strokes.size()) - 6);
  }
}

TEST(DemoApt, WritesToolChangeApproachFeedAndRetract) {
  const Stroke stroke{2, 50, {{{1, 2, -3}, {0, 0, 1}}, {{4, 2, -3}, {0.6, 0, 0.8}}}};
  EXPECT_EQ(apt_text("X", {stroke}, 12),
            "PARTNO/X\nUNITS/MM\nMULTAX/ON\nLOADTL/2\nRAPID\n"
            "GOTO/1.0000,2.0000,12.0000,0.000000,0.000000,1.000000\nDELAY/0.5\nFEDRAT/3000.0,MMPM\n"
            "GOTO/1.0000,2.0000,-3.0000,0.000000,0.000000,1.000000\n"
            "GOTO/4.0000,2.0000,-3.0000,0.600000,0.000000,0.800000\nRAPID\n"
            "GOTO/4.0000,2.0000,12.0000,0.600000,0.000000,0.800000\nFINI\n");
}

TEST(DemoHeightMap, BallRestsOnAStepByItsSide) {
  const HeightMap step({-10, -10, 0}, {10, 10, 0}, 0.1,
                       [](double x, double) { return x < 0 ? 0.0 : 5.0; });
  const HeightMap centers = step.centers_of_ball(2);
  EXPECT_NEAR(centers.at(-5, 0), 2, 1e-9);
  EXPECT_NEAR(centers.at(5, 0), 7, 1e-9);
  EXPECT_NEAR(centers.at(-1, 0), 5 + std::sqrt(3), 1e-9);
}

TEST(DemoHeightMap, HeightsBetweenNodesAreBilinear) {
  const HeightMap slope({0, 0, 0}, {4, 4, 0}, 1, [](double x, double y) { return 2 * x - y; });
  EXPECT_NEAR(slope.at(1.25, 2.5), 0, 1e-12);
  EXPECT_NEAR(slope.at(9, 0), 8, 1e-12) << "outside, the nearest node counts";
  const Vec3 normal = slope.normal(2, 2, 0.5);
  EXPECT_NEAR(normal.x / normal.z, -2, 1e-12);
  EXPECT_NEAR(normal.y / normal.z, 1, 1e-12);
}

}  // namespace
}  // namespace kerf::demo::demo_test
