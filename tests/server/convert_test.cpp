// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/tool_check.h"
#include "server/convert/batch_sum.h"
#include "server/convert/held_cut.h"
#include "server/convert/sample_pose.h"
#include "server/convert/tool_track.h"
#include "server/formats/pose_grid.h"
#include "tests/support/test.h"

namespace kerf::convert_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

wire::MotionSample sample_at(Vec3 tip, Vec3f axis = {0, 0, 1}) {
  return wire::MotionSample{.agent_sequence = 5, .tip_mm = tip, .axis = axis};
}

MotionResult result_of(double force_n, double removed_mm3, double area_mm2) {
  return MotionResult{.wrench = {.force_n = {force_n, 0, 0}},
                      .cutting = {area_mm2, {1, 0, 0}, {area_mm2, 2, 3}},
                      .removed_mm3 = removed_mm3};
}

TEST(ToPose, RoundsToThePoseGrid) {
  const auto pose = test::value_of(to_pose(sample_at({1.23456789, 0, 0}, {0.6F, 0, 0.8F})));
  EXPECT_EQ(pose.tip_mm.x, 1.234568);
  EXPECT_EQ(admit_pose(pose), pose);
  EXPECT_NEAR(length(pose.axis), 1, 1e-8);
}

TEST(ToPose, RejectsInvalidPoses) {
  for (const auto& bad : {sample_at({kNan, 0, 0}), sample_at({0, 0, 2e6}),
                          sample_at({0, 0, 0}, {0, 0, 0}), sample_at({0, 0, 0}, {0, 0, 1.01F}),
                          sample_at({0, 0, 0}, {static_cast<float>(kNan), 0, 1})}) {
    const auto error = test::error_of(to_pose(bad));
    EXPECT_EQ(error.code, wire::ErrorCode::kBadPose);
    EXPECT_NE(error.reason.find("sample 5"), std::string::npos);
  }
}

TEST(BatchSum, ForcesAreTimeWeightedMeans) {
  BatchSum sum;
  sum.add(result_of(10, 1, 4), 0.001);
  sum.add(result_of(40, 2, 8), 0.003);
  wire::Result result;
  sum.write(result);
  EXPECT_FLOAT_EQ(result.force_n.x, (10 * 1 + 40 * 3) / 4.0F);
  EXPECT_FLOAT_EQ(result.removed_mm3, 3);
  EXPECT_EQ(result.status, wire::kStatusCutting);
}

TEST(BatchSum, MarksImprints) {
  for (const double imprint_mm3 : {0.0, 1.5}) {
    BatchSum sum;
    MotionResult first = result_of(0, 2, 0);
    first.imprint_mm3 = imprint_mm3;
    sum.add(first, 0.001);
    sum.add(result_of(10, 1, 4), 0.001);
    wire::Result result;
    sum.write(result);
    EXPECT_EQ((result.status & wire::kStatusImprint) != 0, imprint_mm3 > 0);
    EXPECT_FLOAT_EQ(result.removed_mm3, 3);
  }
}

TEST(BatchSum, UsesTheNewestCuttingModel) {
  BatchSum sum;
  sum.add(result_of(10, 1, 4), 0.001);
  sum.add(result_of(40, 2, 8), 0.001);
  sum.add(result_of(0, 0, 0), 0.001);  // through the air: the model of the last cut remains
  wire::Result result;
  sum.write(result);
  EXPECT_FLOAT_EQ(result.engaged_area_mm2, 8);
  EXPECT_DOUBLE_EQ(result.cut_centre_mm.x, 8);
  EXPECT_FLOAT_EQ(result.specific_force_n_per_mm2, 5);
}

TEST(BatchSum, EmptyBatchHasNoForce) {
  wire::Result result;
  BatchSum().write(result);
  EXPECT_EQ(result, wire::Result{});
}

/// A block under a force law, in which a ball of 6 mm with a holder has cut 1 mm deep.
struct RestingBall {
  explicit RestingBall(ForceLaw law) : block(make(law)) {
    Tool tool = make_tool(BallShape{6, 10}).value();
    EXPECT_TRUE(block.apply(DefineTool{1, tool}));
    BatchSum cut;
    held.add_motion(cut, block, {1, {{0, 0, 1}, {0, 0, 1}}, at, 0.001, true}, result_of(10, 1, 4));
  }
  static Sculpture make(ForceLaw law) {
    return Sculpture::create({.stock = BoxStock{{-10, -10, -10}, {10, 10, 0}},
                              .pitch_mm = 0.5,
                              .force = {.law = law}})
        .value();
  }
  /// Returns the result of a step of 3 ms.
  wire::Result after(const ToolTrack::Step& step) {
    BatchSum sum;
    add_rest(sum, block, step, held);
    wire::Result result;
    sum.write(result);
    return result;
  }
  wire::Result after_rest(Vec3 tip_mm = {0, 0, -1}, ToolId tool = 1) {
    return after(ToolTrack::Rest{tool, {tip_mm, {0, 0, 1}}, 0.003});
  }

  const ToolPose at{{0, 0, -1}, {0, 0, 1}};
  Sculpture block;
  HeldCut held;
};

TEST(HeldCut, AToolAtRestKeepsTheForceOfItsCut) {
  RestingBall ball(ForceLaw::kSpecificEnergy);
  const wire::Result result = ball.after_rest();
  EXPECT_FLOAT_EQ(result.force_n.x, 10);
  EXPECT_FLOAT_EQ(result.engaged_area_mm2, 4);
  EXPECT_EQ(result.removed_mm3, 0) << "it removes nothing";
}

TEST(HeldCut, ForcesOfSpeedEndWithIt) {
  EXPECT_EQ(RestingBall(ForceLaw::kDexelRemovalRate).after_rest().force_n.x, 0);
  EXPECT_EQ(RestingBall(ForceLaw::kMechanistic).after_rest().force_n.x, 0);
}

TEST(HeldCut, EndsWhenTheToolTouchesWithoutCutting) {
  RestingBall ball(ForceLaw::kSpecificEnergy);
  ball.after(ToolTrack::Touch{1, ball.at, 0.001});
  EXPECT_EQ(ball.after_rest().force_n.x, 0);
}

TEST(HeldCut, AppliesToTheNewestToolAndPoseOnly) {
  RestingBall ball(ForceLaw::kSpecificEnergy);
  EXPECT_EQ(ball.after_rest({5, 0, 1}).force_n.x, 0) << "as after a motion that was rejected";
  EXPECT_TRUE(ball.block.apply(DefineTool{2, make_tool(BallShape{6, 10}).value()}));
  EXPECT_EQ(ball.after_rest({0, 0, -1}, 2).force_n.x, 0);
  EXPECT_FLOAT_EQ(ball.after_rest().force_n.x, 10);
}

TEST(HeldCut, AToolAtRestIsPushedByTheStockAsWell) {
  RestingBall ball(ForceLaw::kSpecificEnergy);
  const Tool shank = make_tool(BallShape{6, 4}, {.shank = Shank{10, 20}, .holder = {}}).value();
  EXPECT_TRUE(ball.block.apply(DefineTool{2, shank}));
  const wire::Result result = ball.after_rest({9, 0, -7}, 2);
  EXPECT_GT(result.plane_count, 0U);
  EXPECT_GT(length(Vec3(result.collision_force_n)), 0);
  EXPECT_EQ(result.force_n, result.collision_force_n) << "there is no cut";
}

TEST(HeldCut, AMotionWithoutTravelAddsTheContactToTheHeldForce) {
  RestingBall ball(ForceLaw::kSpecificEnergy);
  BatchSum rest;
  MotionResult touching;
  touching.wrench.force_n = touching.collision.force_n = {0, 2, 0};
  ball.held.add_motion(rest, ball.block, {1, ball.at, ball.at, 0.001, true}, touching);
  wire::Result result;
  rest.write(result);
  EXPECT_FLOAT_EQ(result.force_n.x, 10);
  EXPECT_FLOAT_EQ(result.force_n.y, 2);
  EXPECT_FLOAT_EQ(result.collision_force_n.y, 2);
}

TEST(BatchSum, SetsTheCollidingStatus) {
  MotionResult hit = result_of(3, 0, 0);
  hit.collision.force_n = {3, 0, 0};
  BatchSum sum;
  sum.add(hit, 0.002);
  wire::Result result;
  sum.write(result);
  EXPECT_EQ(result.status, wire::kStatusColliding);
  EXPECT_FLOAT_EQ(result.collision_force_n.x, 3);
}

}  // namespace
}  // namespace kerf::convert_test
