// SPDX-License-Identifier: Apache-2.0
// Invalid numbers: NaN, infinities, denormals, values out of range. Each is rejected with a typed
// error and leaves the state unchanged, bit for bit.

#include "tests/kernel/extremes/carving.h"
#include "tests/support/test.h"

namespace kerf::test::rejection_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kDenormal = std::numeric_limits<double>::denorm_min();
constexpr double kHuge = std::numeric_limits<double>::max();
constexpr Vec3 kUp{0, 0, 1};

const std::vector<double> kUnusable = {kNan, -kNan, kInf, -kInf, kHuge, -kHuge};

/// All numbers of a motion that a test may replace.
double& number_of(MoveTool& move, int which) {
  double* numbers[] = {&move.from.tip_mm.x, &move.from.tip_mm.y, &move.from.tip_mm.z,
                       &move.to.tip_mm.x,   &move.to.tip_mm.y,   &move.to.tip_mm.z,
                       &move.from.axis.x,   &move.from.axis.y,   &move.from.axis.z,
                       &move.to.axis.x,     &move.to.axis.y,     &move.to.axis.z};
  return *numbers[which];
}
constexpr int kNumbers = 12;

TEST(Rejection, InvalidNumbersLeaveTheStateUnchanged) {
  Carving carving(block(20, 10, 0.5, 0.01), *make_tool(BallShape{6, 30}));
  const MoveTool good{1, leaning({-3, 0, -2}, 0.1), leaning({3, 1, -2}, 0.2, 1), 0.01};
  Sculpture& s = carving.sculpture();
  carving.move(good.from, good.to);
  const std::uint64_t state = s.state_hash();
  for (int which = 0; which < kNumbers; ++which) {
    for (const double value : kUnusable) {
      MoveTool bad = good;
      number_of(bad, which) = value;
      const auto moved = s.apply(bad);
      ASSERT_FALSE(moved) << "number " << which << " = " << value;
      EXPECT_FALSE(moved.error().reason.empty());
      EXPECT_FALSE(s.check(bad));
    }
  }
  for (const double value : {kNan, kInf, -kInf, -1.0}) {
    MoveTool bad = good;
    bad.duration_s = value;
    const auto moved = s.apply(bad);
    ASSERT_FALSE(moved) << value;
    EXPECT_EQ(moved.error().code, SculptureErrorCode::kBadDuration);
  }
  EXPECT_EQ(s.state_hash(), state);
  EXPECT_EQ(s.motions(), 1u);
}

TEST(Rejection, DenormalPosesAndDurations) {
  Carving carving(block(20, 10, 0.5, 0.01), *make_tool(BallShape{6, 30}));
  const MoveTool good{1, leaning({-3, 0, -2}, 0.1), leaning({3, 1, -2}, 0.2, 1), 0.01};
  Sculpture& s = carving.sculpture();
  const std::uint64_t state = s.state_hash();
  for (int which = 0; which < kNumbers; ++which) {
    for (const double value : {kDenormal, -kDenormal, 1e-310}) {
      MoveTool bad = good;
      number_of(bad, which) = value;
      const auto moved = s.apply(bad);
      ASSERT_FALSE(moved) << "number " << which << " = " << value;
    }
  }
  MoveTool bad = good;
  bad.duration_s = kDenormal;
  EXPECT_FALSE(s.apply(bad));
  EXPECT_EQ(s.state_hash(), state);
  EXPECT_TRUE(s.apply(good));
}

TEST(Rejection, AxesWithoutADirection) {
  Carving carving(block(20, 10, 0.5, 0.01), *make_tool(BallShape{6, 30}));
  for (const Vec3 axis : {Vec3{}, Vec3{-0.0, 0.0, -0.0}, Vec3{0, 0, 1e-9}, Vec3{0, 0, 2.1},
                          Vec3{1e154, 1e154, 1e154}}) {
    const auto moved =
        carving.sculpture().apply(MoveTool{1, {{0, 0, -2}, kUp}, {{0, 0, -3}, axis}, 0.01});
    ASSERT_FALSE(moved);
    EXPECT_EQ(moved.error().code, SculptureErrorCode::kBadAxis);
  }
}

TEST(Rejection, SettingsOutOfRange) {
  const SculptureSettings good = block(20, 10, 0.5, 0.01);
  const auto rejected = [](const SculptureSettings& s) { return !Sculpture::create(s); };
  ASSERT_FALSE(rejected(good));
  for (const double value : {kNan, kInf, -kInf, kHuge, kDenormal, 0.0, -0.0, -1.0}) {
    SculptureSettings s = good;
    s.pitch_mm = value;
    EXPECT_TRUE(rejected(s)) << "pitch " << value;
    s = good;
    s.tolerance_mm = value;
    EXPECT_TRUE(rejected(s)) << "tolerance " << value;
  }
  for (const double value : {kNan, kInf, -kInf, kHuge, -kHuge}) {
    for (int k = 0; k < 6; ++k) {
      SculptureSettings s = good;
      auto& box = std::get<BoxStock>(s.stock);
      Vec3& corner = k < 3 ? box.min_mm : box.max_mm;
      (k % 3 == 0 ? corner.x : k % 3 == 1 ? corner.y : corner.z) = value;
      EXPECT_TRUE(rejected(s)) << "corner " << k << ' ' << value;
    }
    SculptureSettings s = good;
    s.stock = CylinderStock{0, 0, value, -5, 0};
    EXPECT_TRUE(rejected(s)) << "radius " << value;
    s.stock = CylinderStock{value, 0, 5, -5, 0};
    EXPECT_TRUE(rejected(s)) << "centre " << value;
  }
  for (const double value : {kNan, kInf, -1.0}) {
    SculptureSettings s = good;
    s.force.specific_force_n_per_mm2 = value;
    EXPECT_TRUE(rejected(s));
    s = good;
    s.force.pivot_mm = value;
    EXPECT_TRUE(rejected(s));
  }
}

TEST(Rejection, BlocksTooThinToHoldADepthOrTooLongToCount) {
  SculptureSettings s = block(20, 10, 0.5, 0.01);
  for (const double size : {kDenormal, 1e-300, 1e-30, 9e-5}) {
    for (const Vec3 top : {Vec3{10, 10, size}, Vec3{10, size, 10}, Vec3{size, 10, 10}}) {
      s.stock = BoxStock{{0, 0, 0}, top};
      const auto created = Sculpture::create(s);
      ASSERT_FALSE(created) << size;
      EXPECT_EQ(created.error().code, SculptureErrorCode::kBadStock);
    }
  }
  s.stock = BoxStock{{-1e6, 0, 0}, {1e6, 1e-4, 1}};
  s.pitch_mm = 5e-4;  // One row of 4e9 columns: fewer than 2^32, more than an index can count.
  const auto created = Sculpture::create(s);
  ASSERT_FALSE(created);
  EXPECT_EQ(created.error().code, SculptureErrorCode::kTooManyColumns);
}

TEST(Rejection, ToolsOutOfRange) {
  for (const double value : {kNan, kInf, -kInf, kHuge, kDenormal, 0.0, -1.0, 1e-5, 6000.0}) {
    EXPECT_FALSE(make_tool(BallShape{value, 50})) << value;
    EXPECT_FALSE(make_tool(BallShape{10, value})) << value;
    EXPECT_FALSE(make_tool(FlatShape{value, 50})) << value;
    EXPECT_FALSE(make_tool(FlatShape{10, value})) << value;
    EXPECT_FALSE(make_tool(TaperShape{value, 10, 50})) << value;
    EXPECT_FALSE(make_tool(ConeEndShape{value, 90, 50})) << value;
  }
  for (const double angle : {kNan, kInf, 0.0, -0.0, -5.0, 90.0, 91.0, 1e300}) {
    EXPECT_FALSE(make_tool(TaperShape{4, angle, 40})) << angle;
    EXPECT_FALSE(make_tool(ConeEndShape{4, angle * 2, 40})) << angle;
  }
  EXPECT_FALSE(make_tool(TaperShape{4, std::nextafter(90.0, 0), 40}));
  EXPECT_FALSE(make_tool(ConeEndShape{4, kDenormal, 40}));
  for (const double angle : {kDenormal, 1e-310}) {
    const auto taper = make_tool(TaperShape{4, angle, 40});
    ASSERT_FALSE(taper) << angle;
    EXPECT_EQ(taper.error().code, ToolErrorCode::kOutOfRange);
    EXPECT_EQ(taper.error().field, "half_angle_deg");
  }
  EXPECT_TRUE(make_tool(TaperShape{4, std::numeric_limits<double>::min(), 40}));
  EXPECT_FALSE(make_tool(ConeEndShape{4, 1e-300, 40}));
  for (const double value : {kNan, kInf, -kInf, kHuge, -1.0}) {
    EXPECT_FALSE(make_tool(BullNoseShape{10, value, 50})) << value;
    EXPECT_FALSE(make_tool(AptShape{10, value, 2, 2, 5, 5, 40})) << value;
  }
  for (const double value : {kNan, kInf, -kInf}) {
    EXPECT_FALSE(make_tool(AptShape{value, 2, 3, 2, 0, 0, 40})) << value;
    EXPECT_FALSE(make_tool(AptShape{10, 2, value, 2, 0, 0, 40})) << value;
    EXPECT_FALSE(make_tool(AptShape{10, 2, 3, value, 0, 0, 40})) << value;
    EXPECT_FALSE(make_tool(AptShape{10, 2, 3, 2, value, 0, 40})) << value;
    EXPECT_FALSE(make_tool(AptShape{10, 2, 3, 2, 0, value, 40})) << value;
    EXPECT_FALSE(make_tool(AptShape{10, 2, 3, 2, 0, 0, value})) << value;
  }
  EXPECT_FALSE(make_tool(std::vector<ToolPiece>{}));
  for (const double value : {kNan, kInf, -kInf, kHuge}) {
    EXPECT_FALSE(make_tool({BallPiece{value, 5}}));
    EXPECT_FALSE(make_tool({BallPiece{5, value}}));
    EXPECT_FALSE(make_tool({FrustumPiece{0, value, 10, 5}}));
    EXPECT_FALSE(make_tool({FrustumPiece{0, 5, value, 5}}));
    EXPECT_FALSE(make_tool({FrustumPiece{0, 5, 10, value}}));
  }
}

TEST(Rejection, MotionsThatNeedTooManySubMotions) {
  Carving carving(block(20, 10, 0.5, 1e-6), *make_tool(FlatShape{500, 500}));
  const std::uint64_t state = carving.sculpture().state_hash();
  const auto moved = carving.sculpture().apply(
      MoveTool{1, {{-1e6, 0, -2}, kUp}, {{1e6, 0, -2}, turned(kUp, {0, 1, 0}, 2.9)}, 0.01});
  if (!moved) {
    EXPECT_EQ(moved.error().code, SculptureErrorCode::kTooManySubMotions);
    EXPECT_EQ(carving.sculpture().state_hash(), state);
  }
}

}  // namespace
}  // namespace kerf::test::rejection_test
