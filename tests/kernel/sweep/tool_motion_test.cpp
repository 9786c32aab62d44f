// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/tool_motion.h"

#include "tests/support/test.h"

namespace kerf::tool_motion_test {
namespace {

Vec3 leaning(double angle) { return {std::sin(angle), 0, std::cos(angle)}; }

MotionKind kind(const ToolPose& from, const ToolPose& to) { return make_motion(from, to, 50).kind; }

TEST(ToolMotion, ClassifiesTheFourCases) {
  const Vec3 up{0, 0, 1};
  EXPECT_EQ(kind({{0, 0, 0}, up}, {{0, 0, 0}, up}), MotionKind::kRest);
  EXPECT_EQ(kind({{0, 0, 0}, up}, {{0, 0, -1}, up}), MotionKind::kAxial);
  EXPECT_EQ(kind({{0, 0, 0}, up}, {{0, 0, 1}, up}), MotionKind::kAxial);
  EXPECT_EQ(kind({{0, 0, 0}, up}, {{1, 0, 0}, up}), MotionKind::kTranslation);
  EXPECT_EQ(kind({{0, 0, 0}, up}, {{0, 0, 0}, leaning(0.1)}), MotionKind::kRotation);
  EXPECT_EQ(kind({{0, 0, 0}, up}, {{1, 0, 0}, leaning(0.1)}), MotionKind::kGeneral);
}

TEST(ToolMotion, TinyTurnsAndStepsAreNotRest) {
  const Vec3 up{0, 0, 1};
  EXPECT_EQ(kind({{0, 0, 0}, up}, {{0, 0, 0}, normalized(leaning(1e-9))}), MotionKind::kRotation);
  EXPECT_EQ(kind({{0, 0, 0}, up}, {{1e-9, 0, 0}, up}), MotionKind::kTranslation);
}

TEST(ToolMotion, AxesThatDifferByRoundingAreOneAxis) {
  // Normalizing an axis twice may change its last bit. The sweep treats equal axes as a translation
  // and all different ones as a turn.
  const Vec3 axis = normalized({0.3, 0.2, 0.9});
  const Vec3 other{axis.x, std::nextafter(axis.y, 1), axis.z};
  const ToolMotion m = make_motion({{0, 0, 0}, axis}, {{5, 0, 0}, other}, 50);
  EXPECT_EQ(m.turn_rad, 0);
  EXPECT_EQ(m.to.axis, axis);
  EXPECT_EQ(m.kind, MotionKind::kTranslation);
}

TEST(ToolMotion, PoseAtHalfTheShareIsInTheMiddle) {
  const ToolMotion m = make_motion({{0, 0, 0}, {0, 0, 1}}, {{2, 4, 6}, leaning(0.4)}, 50);
  const ToolPose half = m.at(0.5);
  EXPECT_EQ(half.tip_mm, (Vec3{1, 2, 3}));
  EXPECT_NEAR(half.axis.x, std::sin(0.2), 1e-15);
  EXPECT_NEAR(half.axis.z, std::cos(0.2), 1e-15);
}

}  // namespace
}  // namespace kerf::tool_motion_test
