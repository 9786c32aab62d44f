// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "server/convert/batch_sum.h"
#include "server/convert/held_cut.h"
#include "server/convert/sample_pose.h"
#include "server/formats/pose_grid.h"

namespace kerf {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

wire::MotionSample sample_at(Vec3 tip, Vec3f axis = {0, 0, 1}) {
  wire::MotionSample sample;
  sample.agent_sequence = 5;
  sample.tip_mm = tip;
  sample.axis = axis;
  return sample;
}

MotionResult result_of(double force_n, double removed_mm3, double area_mm2) {
  MotionResult result;
  result.wrench.force_n = {force_n, 0, 0};
  result.removed_mm3 = removed_mm3;
  result.cutting = {area_mm2, {1, 0, 0}, {area_mm2, 2, 3}};
  return result;
}

TEST(ToPose, RoundsToThePoseGrid) {
  const auto pose = to_pose(sample_at({1.23456789, 0, 0}, {0.6F, 0, 0.8F}));
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->tip_mm.x, 1.234568);
  EXPECT_EQ(admit_pose(*pose), *pose);
  EXPECT_NEAR(length(pose->axis), 1, 1e-8);
}

TEST(ToPose, RejectsInvalidPoses) {
  for (const auto& bad : {sample_at({kNan, 0, 0}), sample_at({0, 0, 2e6}),
                          sample_at({0, 0, 0}, {0, 0, 0}), sample_at({0, 0, 0}, {0, 0, 1.01F}),
                          sample_at({0, 0, 0}, {static_cast<float>(kNan), 0, 1})}) {
    const auto pose = to_pose(bad);
    ASSERT_FALSE(pose);
    EXPECT_EQ(pose.error().code, wire::ErrorCode::kBadPose);
    EXPECT_NE(pose.error().reason.find("sample 5"), std::string::npos);
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

/// A block with a ball of 6 mm under a force law.
Sculpture block_with(ForceLaw law) {
  SculptureSettings settings;
  settings.stock = BoxStock{{-10, -10, -10}, {10, 10, 0}};
  settings.pitch_mm = 0.5;
  settings.force.law = law;
  return Sculpture::create(settings).value();
}

/// Force after a cut of 10 N and a rest of 3 ms.
wire::Result rest_after_cut(ForceLaw law, bool dropped = false) {
  const Sculpture block = block_with(law);
  const MoveTool move{1, {{0, 0, 1}, {0, 0, 1}}, {{0, 0, -1}, {0, 0, 1}}, 0.001, true};
  HeldCut held;
  BatchSum cut, rest;
  held.add_motion(cut, block, move, result_of(10, 1, 4));
  if (dropped) held.drop();
  held.add_rest(rest, 0.003);
  wire::Result result;
  rest.write(result);
  return result;
}

TEST(HeldCut, AToolAtRestKeepsTheForceOfItsCut) {
  const wire::Result result = rest_after_cut(ForceLaw::kSpecificEnergy);
  EXPECT_FLOAT_EQ(result.force_n.x, 10);
  EXPECT_FLOAT_EQ(result.engaged_area_mm2, 4);
  EXPECT_EQ(result.removed_mm3, 0) << "it removes nothing";
}

TEST(HeldCut, ForcesOfSpeedEndWithIt) {
  EXPECT_EQ(rest_after_cut(ForceLaw::kDexelRemovalRate).force_n.x, 0);
  EXPECT_EQ(rest_after_cut(ForceLaw::kMechanistic).force_n.x, 0);
}

TEST(HeldCut, IsDroppedWhereTheToolLeavesItsCut) {
  EXPECT_EQ(rest_after_cut(ForceLaw::kSpecificEnergy, true).force_n.x, 0);
}

TEST(HeldCut, AMotionWithoutTravelAddsTheContactToTheHeldForce) {
  const Sculpture block = block_with(ForceLaw::kSpecificEnergy);
  const ToolPose at{{0, 0, -1}, {0, 0, 1}};
  HeldCut held;
  BatchSum cut, rest;
  held.add_motion(cut, block, {1, {{0, 0, 1}, {0, 0, 1}}, at, 0.001, true}, result_of(10, 1, 4));
  MotionResult touching;
  touching.wrench.force_n = touching.collision.force_n = {0, 2, 0};
  held.add_motion(rest, block, {1, at, at, 0.001, true}, touching);
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
}  // namespace kerf
