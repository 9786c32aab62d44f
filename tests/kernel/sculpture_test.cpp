// SPDX-License-Identifier: Apache-2.0
#include "kernel/sculpture.h"

#include "tests/support/test.h"

namespace kerf::sculpture_test {
namespace {

const Vec3 kUp{0, 0, 1};
const double kNan = std::numeric_limits<double>::quiet_NaN();

SculptureSettings settings() {
  return SculptureSettings{.stock = BoxStock{{0, 0, 0}, {30, 30, 20}}};
}

Sculpture sculpture() {
  auto s = *Sculpture::create(settings());
  s.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  s.apply(MoveTool{1, {{5, 5, 16}, kUp}, {{20, 20, 15}, kUp}, 0.1}).value();
  return s;
}

TEST(Sculpture, RejectsBadSettingsWithTheirCode) {
  using enum SculptureErrorCode;
  const auto code = [](auto change) {
    SculptureSettings s = settings();
    change(s);
    const auto made = Sculpture::create(s);
    EXPECT_FALSE(made);
    return made ? kNotFinite : made.error().code;
  };
  EXPECT_EQ(code([](auto& s) { s.stock = BoxStock{{0, 0, 0}, {0, 1, 1}}; }), kBadStock);
  EXPECT_EQ(code([](auto& s) { s.stock = BoxStock{{kNan, 0, 0}, {1, 1, 1}}; }), kBadStock);
  EXPECT_EQ(code([](auto& s) { s.stock = CylinderStock{0, 0, -1, 0, 1}; }), kBadStock);
  EXPECT_EQ(code([](auto& s) { s.pitch_mm = 0; }), kBadPitch);
  EXPECT_EQ(code([](auto& s) { s.pitch_mm = kNan; }), kBadPitch);
  EXPECT_EQ(code([](auto& s) { s.pitch_mm = 1e-4; }), kTooManyColumns);
  EXPECT_EQ(code([](auto& s) { s.tolerance_mm = 0; }), kBadTolerance);
  EXPECT_EQ(code([](auto& s) { s.force.pivot_mm = kNan; }), kBadForce);
  const auto turns_at = [](auto& s, double rpm) {
    s.force.law = ForceLaw::kMechanistic;
    s.force.milling.spindle_rpm = rpm;
  };
  EXPECT_EQ(code([&](auto& s) { turns_at(s, 0.99); }), kBadForce);
  EXPECT_EQ(code([&](auto& s) { turns_at(s, 1e-320); }), kBadForce);
  EXPECT_EQ(code([&](auto& s) { turns_at(s, kNan); }), kBadForce);
  EXPECT_EQ(code([](auto& s) { s.obstacles = {{SphereObstacle{{0, 0, 0}, -1}, 1}}; }),
            kBadObstacle);
}

TEST(Sculpture, RestoresASolidWithoutInterruptingTheForce) {
  auto tried = sculpture(), plain = sculpture();
  const SolidSnapshot before = tried.solid();
  const MoveTool other{1, {{25, 5, 16}, kUp}, {{5, 25, 14}, kUp}, 0.1, false};
  ASSERT_GT(tried.apply(other).value().removed_mm3, 1);
  ASSERT_TRUE(tried.restore(before));
  EXPECT_EQ(tried.state_hash(), plain.state_hash());
  const MoveTool next{1, {{20, 20, 15}, kUp}, {{20.1, 20, 15}, kUp}, 0.01};
  const MotionResult felt = tried.apply(next).value(), expected = plain.apply(next).value();
  EXPECT_EQ(felt.wrench.force_n, expected.wrench.force_n) << "with what was pending";
  EXPECT_GT(length(felt.wrench.force_n), 0.1);
  SculptureSettings three = settings();
  three.rays = Rays::kTriDexel;
  auto others = Sculpture::create(three).value();
  EXPECT_FALSE(others.restore(before));
}

TEST(Sculpture, RestoredBlockDoesNotChangeTheSharedSolid) {
  auto first = sculpture();
  for (int n = 0; n < 4; ++n) {
    first.apply(MoveTool{1, {{25, 5, 18.0 - n}, kUp}, {{5, 25, 18.0 - n}, kUp}, 0.1, false})
        .value();
    const SolidSnapshot solid = first.solid();
    const std::uint64_t hash = solid.hash();
    auto other = sculpture();
    ASSERT_TRUE(other.restore(solid));
    other.apply(MoveTool{1, {{25, 5, 10}, kUp}, {{5, 25, 10}, kUp}, 0.1, false}).value();
    EXPECT_NE(other.state_hash(), hash);
    EXPECT_EQ(solid.hash(), hash) << n;
  }
}

TEST(Sculpture, RejectedCommandChangesNothing) {
  using enum SculptureErrorCode;
  auto s = sculpture();
  const std::uint64_t hash = s.state_hash();
  const std::uint64_t motions = s.motions();
  const ToolPose good{{10, 10, 10}, kUp};
  const auto code = [&](const Command& c) {
    EXPECT_FALSE(s.check(c));
    const auto r = s.apply(c);
    EXPECT_FALSE(r);
    EXPECT_FALSE(r.error().reason.empty());
    return r.error().code;
  };
  EXPECT_EQ(code(MoveTool{9, good, good, 0.1}), kUnknownTool);
  EXPECT_EQ(code(MoveTool{1, good, {{kNan, 0, 0}, kUp}, 0.1}), kNotFinite);
  EXPECT_EQ(code(MoveTool{1, {{0, 0, 0}, {0, kNan, 1}}, good, 0.1}), kNotFinite);
  EXPECT_EQ(code(MoveTool{1, good, {{1e9, 0, 0}, kUp}, 0.1}), kOutOfRange);
  EXPECT_EQ(code(MoveTool{1, good, {{0, 0, 0}, {0, 0, 0}}, 0.1}), kBadAxis);
  EXPECT_EQ(code(MoveTool{1, good, {{0, 0, 0}, {0, 0, 1e-310}}, 0.1}), kBadAxis);
  EXPECT_EQ(code(MoveTool{1, good, {{0, 0, 0}, {0, 0.01, -1}}, 0.1}), kTurnTooLarge);
  EXPECT_EQ(code(MoveTool{1, good, good, -1}), kBadDuration);
  EXPECT_EQ(code(MoveTool{1, good, good, kNan}), kBadDuration);
  EXPECT_EQ(code(DefineTool{2, Tool{}}), kBadTool);
  EXPECT_EQ(s.state_hash(), hash);
  EXPECT_EQ(s.motions(), motions);
}

TEST(Sculpture, RejectsAMotionWithTooManySubMotions) {
  SculptureSettings slow = settings();
  slow.tolerance_mm = 1e-6;
  slow.motion = MotionModel::kPaper;
  auto s = *Sculpture::create(slow);
  s.apply(DefineTool{1, *make_tool(FlatShape{10, 50})}).value();
  const auto r = s.apply(MoveTool{1, {{10, 10, 10}, kUp}, {{10, 10, 10}, {1, 0, 0.1}}, 1});
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().code, SculptureErrorCode::kTooManySubMotions);
}

TEST(Sculpture, CarvesTurnsOfUpTo170Degrees) {
  auto s = sculpture();
  const double angle = 169.9 * M_PI / 180;
  const auto r = s.apply(
      MoveTool{1, {{15, 15, 12}, kUp}, {{15, 15, 12}, {std::sin(angle), 0, std::cos(angle)}}, 1});
  ASSERT_TRUE(r);
  EXPECT_GT(r->removed_mm3, 0);
}

TEST(Sculpture, RedefiningAToolChangesLaterCutsOnly) {
  auto s = sculpture();
  const std::uint64_t hash = s.state_hash();
  s.apply(DefineTool{1, *make_tool(FlatShape{4, 20})}).value();
  EXPECT_EQ(s.state_hash(), hash);
  EXPECT_EQ(s.tool(1)->radius_mm, 2);
}

}  // namespace
}  // namespace kerf::sculpture_test
