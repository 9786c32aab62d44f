// SPDX-License-Identifier: Apache-2.0
#include "server/formats/pose_grid.h"

#include "server/formats/number_text.h"
#include "tests/support/test.h"

namespace kerf::pose_grid_test {
namespace {

std::array<double, 6> numbers(const ToolPose& p) {
  return {p.tip_mm.x, p.tip_mm.y, p.tip_mm.z, p.axis.x, p.axis.y, p.axis.z};
}

bool same_bits(const ToolPose& a, const ToolPose& b) {
  for (std::size_t i = 0; i < 6; ++i)
    if (std::bit_cast<std::uint64_t>(numbers(a)[i]) != std::bit_cast<std::uint64_t>(numbers(b)[i]))
      return false;
  return true;
}

ToolPose random_pose(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double scale = std::exp(normal(random) * 4);
  return {Vec3{normal(random), normal(random), normal(random)} * scale,
          Vec3{normal(random), normal(random), normal(random)} * (1 + std::abs(normal(random)))};
}

TEST(PoseGrid, AdmissionIsIdempotent) {
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    std::mt19937_64 random(seed);
    const ToolPose once = admit_pose(random_pose(random));
    ASSERT_TRUE(same_bits(admit_pose(once), once)) << "seed " << seed;
  }
}

TEST(PoseGrid, TextReadsBackToTheSameBits) {
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    std::mt19937_64 random(seed);
    const auto pose = numbers(admit_pose(random_pose(random)));
    for (std::size_t i = 0; i < 6; ++i) {
      const std::string text = exact_text(pose[i]);
      const auto point = text.find('.');
      const std::size_t decimals = point == std::string::npos ? 0 : text.size() - point - 1;
      ASSERT_LE(decimals, i < 3 ? 6u : 9u) << text << " seed " << seed;
      double back = 0;
      std::from_chars(text.data(), text.data() + text.size(), back);
      ASSERT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(pose[i])) << text;
    }
  }
}

TEST(PoseGrid, MovesPosesByAtMostOneStep) {
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    std::mt19937_64 random(seed);
    const ToolPose pose = random_pose(random);
    const ToolPose grid = admit_pose(pose);
    const double tip = length(grid.tip_mm - pose.tip_mm);
    ASSERT_LE(tip, kTipGridMm) << "seed " << seed;
    ASSERT_LE(length(grid.axis - normalized(pose.axis)), kAxisGrid) << "seed " << seed;
  }
}

TEST(PoseGrid, NegativeZeroBecomesZero) {
  const ToolPose pose = admit_pose({{-0.0, -1e-9, 0}, {-0.0, 0, 1}});
  EXPECT_FALSE(std::signbit(pose.tip_mm.x));
  EXPECT_FALSE(std::signbit(pose.tip_mm.y));
  EXPECT_FALSE(std::signbit(pose.axis.x));
}

TEST(NumberText, IsShortAndWithoutExponent) {
  EXPECT_EQ(exact_text(0.1), "0.1");
  EXPECT_EQ(exact_text(-0.0), "0");
  EXPECT_EQ(exact_text(1e-6), "0.000001");
  EXPECT_EQ(exact_text(1e22), "10000000000000000000000");
  EXPECT_EQ(decimal_text(1.5, 6), "1.5");
  EXPECT_EQ(decimal_text(-1e-9, 6), "0");
  EXPECT_EQ(decimal_text(100, 6), "100");
  EXPECT_EQ(significant_text(599.99999999, 7), "600");
  EXPECT_EQ(significant_text(123456789, 7), "123456800");
}

}  // namespace
}  // namespace kerf::pose_grid_test
